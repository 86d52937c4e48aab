//! What nobody would write, to the readers of files.

use anyhow::{Result, bail};
use clap::Args;
use xshell::Shell;

#[derive(Args)]
pub(crate) struct Options {}

pub(crate) fn run(_shell: &Shell, _options: &Options) -> Result<()> {
    bail!("not yet here")
}
