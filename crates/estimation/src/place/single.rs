//! Scaffold until the bank.
use super::state::{Seen, State, Stretch, Taken};
use serde::{Deserialize, Serialize};

/// One hypothesis.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, Default)]
pub struct Bank {
    state: Option<State>,
}

impl Bank {
    /// Placed.
    pub fn start(&mut self, state: State) {
        self.state = Some(state);
    }
    /// Best.
    pub fn best(&self) -> Option<&State> {
        self.state.as_ref()
    }
    /// Change each.
    pub fn change(&mut self, change: impl Fn(&mut State)) {
        if let Some(state) = &mut self.state {
            change(state);
        }
    }
    /// Walk.
    pub fn walk(&mut self, stretch: &Stretch) {
        if let Some(state) = &mut self.state {
            state.walk(stretch);
        }
    }
    /// Take.
    pub fn take<const M: usize>(&mut self, see: impl Fn(&State) -> Seen<M>, bound: f64) -> Option<Taken> {
        let state = self.state.as_mut()?;
        let seen = see(state);
        state.take(&seen, bound)
    }
}
