"""Measures times, and prints figures in the format of all peers: one line of JSON each."""

import json
import time


def median_us(job, per_call=1, batches=9, batch_s=0.02):
    """Median over batches of the time of one call, divided by per_call, the number of items per call; microseconds.

    A batch repeats the call for about batch_s seconds, at least once. The first batch is a warm-up and does not count.
    """
    start = time.perf_counter()
    job()
    calls = max(1, int(batch_s / (time.perf_counter() - start)))
    times = []
    for _ in range(batches + 1):
        start = time.perf_counter()
        for _ in range(calls):
            job()
        times.append((time.perf_counter() - start) / calls)
    return sorted(times[1:])[batches // 2] / per_call * 1e6


def medians_us(jobs, per_call=1, batches=9, batch_s=0.02):
    """Medians as by median_us for several jobs that alternate batch by batch, so that a busy machine slows all alike.

    The times are processor times of this thread.
    """
    calls = []
    for job in jobs:
        start = time.thread_time()
        job()
        calls.append(max(1, int(batch_s / (time.thread_time() - start))))
    times = [[] for _ in jobs]
    for _ in range(batches + 1):
        for job, count, own in zip(jobs, calls, times, strict=True):
            start = time.thread_time()
            for _ in range(count):
                job()
            own.append((time.thread_time() - start) / count)
    return [sorted(own[1:])[batches // 2] / per_call * 1e6 for own in times]


def print_figure(task, peer, version, time_us, error):
    """Prints the time and the error of a task as one line of JSON."""
    figure = {"task": task, "peer": peer, "version": version, "time_us": float(time_us), "error": float(error)}
    print(json.dumps(figure), flush=True)
