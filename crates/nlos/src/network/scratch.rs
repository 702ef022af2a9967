//! Memory that a network works in.

use super::{FIRST, Network, STEPS, TOGETHER};

/// Memory that a network works in; one for each thread, used again by every call.
#[derive(Debug, Clone, Default)]
pub struct Scratch {
    pub(super) first: Vec<f32>,
    pub(super) second: Vec<f32>,
    pub(super) gates: Vec<f32>,
    pub(super) hidden: Vec<f32>,
    pub(super) cell: Vec<f32>,
    pub(super) found: Vec<f32>,
}

impl Scratch {
    /// Makes room for a network; the second time for the same one there is nothing to do.
    pub(super) fn fit(&mut self, network: &Network) {
        self.found.resize(network.head.inputs(), 0.0);
        if let Some(response) = &network.response {
            let state = response.state();
            self.first.resize(FIRST * response.first.outputs(), 0.0);
            self.second.resize(STEPS * response.second.outputs(), 0.0);
            self.gates.resize(STEPS * TOGETHER * 4 * state, 0.0);
            self.hidden.resize(TOGETHER * state, 0.0);
            self.cell.resize(TOGETHER * state, 0.0);
        }
    }
}
