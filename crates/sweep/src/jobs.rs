//! Jobs into which the runner divides the blocks of a study.

/// Blocks per thread after which sums are folded. Large against the blocks of one job, so that threads rarely wait.
const WAVE: u64 = 1024;
/// Most blocks of one job; a job has its own histograms, whose merging must not be felt.
const MAX_JOB: u64 = 32;
/// Jobs per thread, where there are few blocks.
const JOBS_PER_THREAD: u64 = 8;

/// Number of blocks that are run before sums are folded.
pub(crate) fn blocks_of_wave(threads: usize) -> u64 {
    WAVE * threads as u64
}

/// Number of blocks of a job, where so many blocks remain.
pub(crate) fn blocks_of_job(blocks: u64, threads: usize) -> u64 {
    let blocks = blocks.min(blocks_of_wave(threads));
    (blocks / (JOBS_PER_THREAD * threads as u64)).clamp(1, MAX_JOB)
}
