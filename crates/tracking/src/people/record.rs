//! People and tags as they are entered.

use adit_core::time::Time;
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;

/// Somebody who may go below.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Person {
    /// Its id: a number of the staff, say.
    pub id: String,
    /// Name.
    pub name: String,
    /// Team.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub team: Option<String>,
    /// How to reach them or their next of kin.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub contact: Option<String>,
    /// The shift they work in, as the mine calls it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shift: Option<String>,
    /// How long they may be below, h; the rule's where it is not given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shift_limit_h: Option<f64>,
    /// Ids of the restricted zones that they may enter.
    #[serde(default, skip_serializing_if = "BTreeSet::is_empty")]
    pub allowed_zones: BTreeSet<String>,
}

/// What a tag is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum TagKind {
    /// Worn by people. Where nobody is assigned, it counts as an unknown person.
    #[default]
    Person,
    /// On a vehicle: followed, but not counted and without alarms of people.
    Vehicle,
    /// On a thing: as a vehicle.
    Asset,
}

/// Where a tag is worn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Worn {
    /// On the foot.
    Foot,
    /// At the waist.
    Waist,
    /// On the helmet, as part of the lamp.
    Helmet,
    /// On the chest.
    Chest,
    /// On the wrist.
    Wrist,
    /// In a pocket.
    Pocket,
}

/// A tag.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Tag {
    /// Its id, as it sends it.
    pub id: String,
    /// What it is for.
    #[serde(default)]
    pub kind: TagKind,
    /// Where it is worn.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub worn: Option<Worn>,
    /// Name for people: the number of a vehicle, say.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
}

/// Who wears a tag, from when until when.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Assignment {
    /// The tag.
    pub tag: String,
    /// Id of the person.
    pub person: String,
    /// From when.
    pub from: Time,
    /// Until when, not included; for good where it is not given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub until: Option<Time>,
}

/// Who is where: a person, or a tag that nobody is known to wear.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Subject {
    /// A person, by id.
    Person(String),
    /// A tag without a person, by id.
    Tag(String),
}
