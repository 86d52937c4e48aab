"""Finds markers with OpenCV: 77 coloured discs on a dark ground; brightness-weighted centroids and mean hues.

Reads DIRECTORY/frame-640.rgb and frame-1024.rgb, and the true centroids in frame-640.csv and frame-1024.csv. A white
top-hat removes the uneven light. Its kernel is a rectangle, which is fastest.

Error: rms error of the centroid over the markers, px; infinite unless each marker is found exactly once.
"""

import sys

import cv2
import numpy as np
from figure import median_us, print_figure

LEAST_LIGHT, LEAST_PIXELS = 45, 30
TURN = 2 * np.pi * np.arange(256) / 256
COSINE, SINE = np.cos(TURN), np.sin(TURN)


def circle(size, share):
    """Mask of a circle around the centre of a frame; its radius is share times the size of the frame."""
    along = np.arange(size) - size / 2
    return (along[:, None] ** 2 + along[None, :] ** 2 <= (share * size) ** 2).astype(np.uint8) * 255


def markers(frame, lens, within, kernel):
    """Centroids (px) and hues (degrees) of the markers."""
    hsv = cv2.cvtColor(cv2.bitwise_and(frame, frame, mask=lens), cv2.COLOR_RGB2HSV_FULL)
    light = cv2.morphologyEx(cv2.extractChannel(hsv, 2), cv2.MORPH_TOPHAT, kernel)
    light = cv2.bitwise_and(light, light, mask=within)
    _, lit = cv2.threshold(light, LEAST_LIGHT, 255, cv2.THRESH_BINARY)
    count, labels, statistics, _ = cv2.connectedComponentsWithStats(lit, connectivity=8)
    pixels = np.flatnonzero(labels.ravel())
    label, weight = labels.ravel()[pixels], light.ravel()[pixels].astype(np.float64)
    hue = cv2.extractChannel(hsv, 0).ravel()[pixels]
    sums = [np.bincount(label, of, count) for of in (weight, weight * (pixels % frame.shape[1]), weight * (pixels // frame.shape[1]), COSINE[hue], SINE[hue])]
    large = np.flatnonzero(statistics[1:, cv2.CC_STAT_AREA] > LEAST_PIXELS) + 1
    total, x, y, cosine, sine = (of[large] for of in sums)
    return np.column_stack([x / total, y / total]), np.degrees(np.arctan2(sine, cosine)) % 360


def centroid_error(found, truth):
    """Rms distance (px) between each true marker and the nearest found one."""
    distance = np.hypot(*(found[:, None, :] - truth[None, :, :]).transpose(2, 0, 1))
    nearest = distance.argmin(0)
    if len(found) != len(truth) or len(set(nearest)) != len(truth):
        return np.inf
    return np.sqrt(np.mean(distance.min(0) ** 2))


cv2.setNumThreads(1)
for size in (640, 1024):
    frame = np.fromfile(f"{sys.argv[1]}/frame-{size}.rgb", np.uint8).reshape(size, size, 3)
    truth = np.loadtxt(f"{sys.argv[1]}/frame-{size}.csv", delimiter=",", skiprows=1)
    side = 2 * round(0.02 * size) + 1
    # The top-hat filter brightens a ring at the rim of the lens. The narrower circle excludes this ring from the
    # result.
    given = frame, circle(size, 0.48), circle(size, 0.47), cv2.getStructuringElement(cv2.MORPH_RECT, (side, side))
    error = centroid_error(markers(*given)[0], truth[:, :2])
    time_us = median_us(lambda: markers(*given))
    print_figure(f"image, {size} px, 77 markers", "OpenCV, rectangular top-hat", cv2.__version__, time_us, error)
