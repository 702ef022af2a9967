//! Who sent, who measured: names of devices.

use alloc::sync::Arc;
use core::borrow::Borrow;
use core::fmt;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// The name of an anchor, access point, beacon, reader or tag, as in the mine's file or as the device gives itself.
///
/// A clone shares the text, so that a reader that keeps the names it has met allocates nothing per observation.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct DeviceId(Arc<str>);

impl DeviceId {
    /// A longer name is a mistake, bytes.
    pub const LONGEST: usize = 64;

    /// From text; `None` when it is empty, longer than [`Self::LONGEST`] bytes, or has blanks around it or control characters.
    pub fn new(name: &str) -> Option<Self> {
        let fits = (1..=Self::LONGEST).contains(&name.len());
        let readable = name.trim() == name && !name.chars().any(char::is_control);
        (fits && readable).then(|| Self(name.into()))
    }

    /// As text.
    pub fn as_str(&self) -> &str {
        &self.0
    }
}

/// Hashes and compares as its text does.
impl Borrow<str> for DeviceId {
    fn borrow(&self) -> &str {
        &self.0
    }
}

impl fmt::Display for DeviceId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl Serialize for DeviceId {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(&self.0)
    }
}

impl<'de> Deserialize<'de> for DeviceId {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let name = alloc::string::String::deserialize(deserializer)?;
        Self::new(&name).ok_or_else(|| {
            serde::de::Error::custom(format_args!(
                "\"{name}\" is no name of a device: 1 to 64 bytes, no blanks around"
            ))
        })
    }
}
