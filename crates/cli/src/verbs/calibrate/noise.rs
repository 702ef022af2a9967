use crate::args::CalibrateNoiseArgs;
use anyhow::{Result, bail};
pub fn run(_args: &CalibrateNoiseArgs) -> Result<()> {
    bail!("not yet")
}
