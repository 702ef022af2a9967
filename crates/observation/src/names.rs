//! Names of devices met so far, each kept once.

use crate::device::DeviceId;
use std::collections::HashSet;

/// Names kept; a log with more gets those beyond as texts of their own, so that memory stays bounded.
const MOST_KEPT: usize = 4096;

/// The names that a reader has met: one met again costs no memory.
#[derive(Debug, Default)]
pub(crate) struct Names {
    known: HashSet<DeviceId>,
}

/// What a name is, for an error.
pub(crate) const EXPECTED_NAME: &str =
    "a name of a device: 1 to 64 bytes, no blanks around, no control characters";

impl Names {
    /// The device of this name; `None` when no device can have it.
    pub(crate) fn device(&mut self, name: &str) -> Option<DeviceId> {
        if let Some(known) = self.known.get(name) {
            return Some(known.clone());
        }
        let device = DeviceId::new(name)?;
        if self.known.len() < MOST_KEPT {
            self.known.insert(device.clone());
        }
        Some(device)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_met_again_is_the_same_text_and_memory_is_bounded() {
        let mut names = Names::default();
        let text = |device: DeviceId| device.as_str().as_ptr();
        let first = names.device("a 1").map(text);
        assert!(first.is_some() && first == names.device("a 1").map(text));
        assert_eq!(names.device(" a 1"), None);
        for number in 0..2 * MOST_KEPT {
            assert!(names.device(&number.to_string()).is_some());
        }
        assert_eq!(names.known.len(), MOST_KEPT);
    }
}
