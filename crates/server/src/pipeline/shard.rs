//! Some of the tags: those whose names fall to it.

use super::follower::{Arrival, Follower, TagHealth};
use super::profile::Profiles;
use crate::seldom::Seldom;
use adit_nlos::network::Scratch;
use adit_observation::wire::PacketReader;
use adit_tracking::Input;
use prost::bytes::Bytes;
use std::collections::BTreeMap;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::sync::Arc;

/// Some of the tags.
pub struct Shard {
    followers: BTreeMap<String, Follower>,
    profiles: Arc<Profiles>,
    reader: PacketReader,
    scratch: Scratch,
    /// The last tag that the running snapshot has.
    kept: Option<String>,
    /// Tags that came since it began.
    came_since: Vec<String>,
}

/// A packet to take.
pub struct Job {
    /// Its place in the round.
    pub order: usize,
    /// How it came.
    pub arrival: Arrival,
    /// The packet.
    pub packet: Bytes,
}

/// What a packet told.
pub struct Told {
    /// Place of the packet in the round.
    pub order: usize,
    /// For the tracking, in order.
    pub inputs: Vec<Input>,
}

/// Which shard of so many a tag falls to.
pub fn shard_of(tag: &str, shards: usize) -> usize {
    let mut hasher = DefaultHasher::new();
    tag.hash(&mut hasher);
    usize::try_from(hasher.finish() % shards.max(1) as u64).unwrap_or_default()
}

impl Shard {
    /// Without tags.
    pub fn new(profiles: Arc<Profiles>) -> Self {
        Self {
            followers: BTreeMap::new(),
            profiles,
            reader: PacketReader::default(),
            scratch: Scratch::default(),
            kept: None,
            came_since: Vec::new(),
        }
    }

    /// How many tags.
    pub fn tags(&self) -> usize {
        self.followers.len()
    }

    /// Takes packets, in order.
    pub fn take(&mut self, jobs: Vec<Job>) -> Vec<Told> {
        static BAD: Seldom = Seldom::new();
        let mut told = Vec::with_capacity(jobs.len());
        for Job { order, arrival, packet } in jobs {
            let mut inputs = Vec::new();
            match self.reader.read(&packet) {
                Ok(packet) => self.follow(packet, &arrival, &mut inputs),
                Err(error) => {
                    metrics::counter!("adit_bad_packets_total").increment(1);
                    BAD.warn(format_args!("gateway {:?}: a packet that is none: {error}", arrival.gateway));
                }
            }
            told.push(Told { order, inputs });
        }
        told
    }

    fn follow(&mut self, packet: adit_observation::wire::Packet, arrival: &Arrival, inputs: &mut Vec<Input>) {
        let Some(profile) = self.profiles.of(packet.tag.as_str()) else {
            metrics::counter!("adit_packets_without_profile_total").increment(1);
            return;
        };
        if !self.followers.contains_key(packet.tag.as_str()) {
            self.followers.insert(packet.tag.as_str().to_owned(), Follower::new(profile));
            self.came_since.push(packet.tag.as_str().to_owned());
        }
        let Some(follower) = self.followers.get_mut(packet.tag.as_str()) else { return };
        // What the snapshot holds already.
        if arrival.position.is_some_and(|position| position <= follower.held()) {
            return;
        }
        follower.take(packet, arrival, (profile, &mut self.scratch), inputs);
    }

    /// How a tag is followed.
    pub fn health(&self, tag: &str) -> Option<TagHealth> {
        let follower = self.followers.get(tag)?;
        Some(follower.health(tag, self.profiles.named(follower.profile())?))
    }

    /// The numbers of packets that came of each tag.
    pub fn packets(&self) -> impl Iterator<Item = (String, Vec<(u64, u64)>)> + '_ {
        self.followers.iter().map(|(tag, follower)| (tag.clone(), follower.packets().collect()))
    }

    /// Takes a tag back as a snapshot has it; one whose profile is gone or has changed begins anew.
    pub fn restore(&mut self, tag: String, mut follower: Follower) {
        let Some(profile) = self.profiles.of(&tag) else { return };
        if profile.name == follower.profile() {
            follower.attach(profile);
            self.followers.insert(tag, follower);
        }
    }

    /// Up to so many further tags for the running snapshot, in the order of their names; none when all are in it.
    pub fn next_kept(&mut self, most: usize) -> Vec<(String, Follower)> {
        use std::ops::Bound::{Excluded, Unbounded};
        let from = self.kept.as_deref().map_or(Unbounded, Excluded);
        let next = self.followers.range::<str, _>((from, Unbounded)).take(most);
        let next: Vec<_> = next.map(|(tag, follower)| (tag.clone(), follower.kept())).collect();
        if let Some((last, _)) = next.last() {
            self.kept = Some(last.clone());
        }
        next
    }

    /// The next snapshot begins with the first tag.
    pub fn begin_snapshot(&mut self) {
        self.kept = None;
        self.came_since.clear();
    }

    /// Tags that came since the running snapshot began, and which it had passed by then.
    pub fn not_kept(&mut self) -> Vec<(String, Follower)> {
        let passed = self.kept.as_ref();
        let missed = self.came_since.drain(..).filter(|tag| passed.is_some_and(|kept| tag <= kept));
        missed.filter_map(|tag| self.followers.get(&tag).map(|follower| (tag, follower.kept()))).collect()
    }
}
