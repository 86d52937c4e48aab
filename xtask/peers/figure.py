"""A figure as every peer prints it: one line of JSON."""

import json
import time


def median_us(job, per_call=1, batches=9, batch_s=0.02):
    """Median over batches of the time of one call, divided by what a call does, in microseconds.

    A batch has as many calls as last for batch_s, at least one; one batch goes before to warm up.
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
    """Medians as of median_us of jobs that take turns, batch by batch, of the time that this thread has the processor:
    a busy machine slows all of them alike."""
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


def tell(task, peer, version, time_us, error):
    """Prints the figure."""
    figure = {"task": task, "peer": peer, "version": version, "time_us": float(time_us), "error": float(error)}
    print(json.dumps(figure), flush=True)
