//! What is known, on request.

use crate::alarms::{About, Alarm, AlarmId};
use crate::evacuation::{EvacuationStatus, EvacuationSummary, EvacuationView, Evacuee, Mark};
use crate::ground::Ground;
use crate::input::DeviceKind;
use crate::people::{Subject, TagRecord};
use crate::presence::{Day, Presence, Seen, Who};
use crate::rules::Rules;
use crate::time::seconds;
use crate::tracking::Tracking;
use crate::view::{
    DeviceView, Headcount, LastKnown, PersonView, StayView, SubjectView, TagView, Whereabouts, ZoneView,
};
use crate::zones::Shape;
use adit_core::time::{Interval, Time};
use adit_mine::Mine;
use std::sync::Arc;

impl Tracking {
    /// The time of the last input.
    pub fn now(&self) -> Time {
        self.now
    }

    /// The rules.
    pub fn rules(&self) -> &Rules {
        &self.rules
    }

    /// The mine; none after reading back, before [`Self::attach`].
    pub fn mine(&self) -> Option<&Arc<Mine>> {
        self.ground.as_ref().map(|ground| &ground.mine)
    }

    /// All people, by id.
    pub fn people(&self) -> impl Iterator<Item = PersonView> + '_ {
        self.roster.people.keys().filter_map(|id| self.person(id))
    }

    /// A person.
    pub fn person(&self, id: &str) -> Option<PersonView> {
        let record = self.roster.people.get(id)?;
        let live = self.view(&Who::person(&record.person), &record.presence)?;
        Some(PersonView { person: record.person.clone(), tags: record.tags.iter().cloned().collect(), live })
    }

    /// All tags, by id.
    pub fn tags(&self) -> impl Iterator<Item = TagView> + '_ {
        self.roster.tags.keys().filter_map(|id| self.tag(id))
    }

    /// A tag.
    pub fn tag(&self, id: &str) -> Option<TagView> {
        let record = self.roster.tags.get(id)?;
        let presence = self.presence_by(record, id);
        Some(TagView {
            tag: record.tag.clone(),
            registered: record.registered,
            person: record.wearer.clone(),
            assignments: record.assignments.clone(),
            last_known: self.tag_seen(record, presence),
            in_contact: self.is_heard(record.heard),
            last_heard: record.heard,
            gateway: record.gateway.clone(),
            battery: record.battery,
            motion: presence.and_then(|presence| presence.stillness.view()),
        })
    }

    fn tag_seen(&self, record: &TagRecord, presence: Option<&Presence>) -> Option<LastKnown> {
        let seen = record.seen.as_ref()?;
        let leading = presence.filter(|presence| presence.seen.as_ref() == Some(seen));
        let roaming = leading.map_or_else(
            || self.now.since(seen.time),
            |presence| presence.stillness.roaming(seen.time, self.now),
        );
        let ground = self.ground.as_ref()?;
        let level = ground.levels.of(leading.and_then(|p| p.level), seen.position_m.raw().z, 0.0);
        self.last_known(&record.tag.id, seen, roaming, level)
    }

    /// Who wears a tag now.
    pub fn wearer(&self, tag: &str) -> Option<&str> {
        self.roster.tags.get(tag)?.wearer.as_deref()
    }

    /// The zone entered last, of those that somebody followed by this tag is in.
    pub fn zone_of(&self, tag: &str) -> Option<&str> {
        let presence = self.presence_by(self.roster.tags.get(tag)?, tag)?;
        Some(&presence.stays.iter().max_by_key(|stay| stay.since)?.zone)
    }

    /// The presence that a tag tells of: its own, or its wearer's where that one is followed by it.
    fn presence_by<'a>(&'a self, record: &'a TagRecord, id: &str) -> Option<&'a Presence> {
        let Some(wearer) = &record.wearer else { return Some(&record.presence) };
        let person = self.roster.people.get(wearer)?;
        (person.lead.as_deref() == Some(id)).then_some(&person.presence)
    }

    /// Somebody, or a tag that nobody is known to wear.
    pub fn live(&self, subject: &Subject) -> Option<SubjectView> {
        match subject {
            Subject::Person(id) => self.person(id).map(|person| person.live),
            Subject::Tag(id) => {
                let record = self.roster.tags.get(id).filter(|record| record.wearer.is_none())?;
                self.view(&Who::tag(id, record.tag.kind), &record.presence)
            }
        }
    }

    /// Everybody and everything that is below, people first, by id.
    pub fn below(&self) -> impl Iterator<Item = SubjectView> + '_ {
        let below = self.roster.everybody_seen().filter(|(_, presence)| presence.is_below());
        below.filter_map(|(who, presence)| self.view(&who, presence))
    }

    fn view(&self, who: &Who<'_>, presence: &Presence) -> Option<SubjectView> {
        let ground = self.ground.as_ref()?;
        let whereabouts = match presence.day {
            Day::Unseen => Whereabouts::Unseen,
            Day::Below { shift_since } => Whereabouts::Below { shift_since },
            Day::Out { since, .. } => Whereabouts::Out { since },
        };
        let stays = presence.stays.iter();
        let subject = who.subject();
        Some(SubjectView {
            kind: who.kind,
            whereabouts,
            last_known: self.presence_seen(presence),
            zones: stays.map(|stay| StayView { zone: stay.zone.clone(), since: stay.since }).collect(),
            possible_zones: self.possible(ground, presence).map(|shape| shape.id().to_owned()).collect(),
            in_contact: self.is_heard(presence.heard),
            last_heard: presence.heard,
            gateway: presence.gateway.clone(),
            motion: presence.stillness.view(),
            alarms: self.alarms.about(&About::from(subject.clone())),
            subject,
        })
    }

    fn presence_seen(&self, presence: &Presence) -> Option<LastKnown> {
        let seen = presence.seen.as_ref()?;
        let roaming = presence.stillness.roaming(seen.time, self.now);
        self.last_known(&presence.seen_by, seen, roaming, presence.level)
    }

    /// Zones that somebody below may be in, though nobody can tell.
    fn possible<'a>(
        &self,
        ground: &'a Ground,
        presence: &'a Presence,
    ) -> impl Iterator<Item = &'a Shape> + use<'a> {
        let now = self.radius_now_m(presence);
        let seen = presence.seen.as_ref().zip(now).filter(|_| presence.is_below());
        let may = move |shape: &&Shape| {
            seen.is_some_and(|(seen, radius_m)| {
                shape.may_hold(presence.level, seen.plan_m(), radius_m)
                    && !presence.stays.iter().any(|stay| stay.zone == shape.id())
            })
        };
        ground.watch.shapes().iter().filter(may)
    }

    fn radius_now_m(&self, presence: &Presence) -> Option<f64> {
        let seen = presence.seen.as_ref()?;
        self.grown_m(seen, presence.stillness.roaming(seen.time, self.now))
    }

    /// The radius that holds whoever walked for so long since: no larger than the mine.
    fn grown_m(&self, seen: &Seen, roaming: Interval) -> Option<f64> {
        let grown_m = seen.radius_95_m + self.rules.position.growth_m_s * roaming.seconds();
        Some(grown_m.min(self.ground.as_ref()?.reach_m(&seen.position_m)).max(seen.radius_95_m))
    }

    fn last_known(&self, tag: &str, seen: &Seen, roaming: Interval, level: Option<u16>) -> Option<LastKnown> {
        let ground = self.ground.as_ref()?;
        Some(LastKnown {
            tag: tag.into(),
            time: seen.time,
            position_m: seen.position_m,
            velocity_m_s: seen.velocity_m_s,
            radius_95_m: seen.radius_95_m,
            radius_now_m: self.grown_m(seen, roaming)?,
            protection_level_m: seen.protection_level_m,
            quality: seen.quality,
            method: seen.method.clone(),
            level: level.and_then(|level| ground.levels.id(level)).map(Into::into),
            age_s: self.now.since(seen.time).seconds(),
        })
    }

    fn is_heard(&self, heard: Option<Time>) -> bool {
        heard.is_some_and(|heard| self.now.since(heard) <= seconds(self.rules.contact.lost_after_s))
    }

    /// All zones, by id, with those who are in them.
    pub fn zones(&self) -> Vec<ZoneView> {
        let Some(ground) = &self.ground else { return Vec::new() };
        let mut zones: Vec<ZoneView> = ground
            .watch
            .shapes()
            .iter()
            .zip(&self.counts.zones)
            .map(|(shape, count)| ZoneView {
                live: shape.live.clone(),
                count: *count,
                inside: Vec::new(),
                possible: Vec::new(),
            })
            .collect();
        for (who, presence) in self.roster.everybody_seen() {
            for zone in presence.stays.iter().filter_map(|stay| ground.watch.index(&stay.zone)) {
                zones[zone].inside.push(who.subject());
            }
            for zone in self.possible(ground, presence).filter_map(|shape| ground.watch.index(shape.id())) {
                zones[zone].possible.push(who.subject());
            }
        }
        zones
    }

    /// A zone with those who are in it.
    pub fn zone(&self, id: &str) -> Option<ZoneView> {
        let ground = self.ground.as_ref()?;
        let index = ground.watch.index(id)?;
        let everybody = || self.roster.everybody_seen();
        let is_in = |presence: &Presence| presence.stays.iter().any(|stay| stay.zone == id);
        let may_be = |presence: &Presence| self.possible(ground, presence).any(|shape| shape.id() == id);
        Some(ZoneView {
            live: ground.watch.get(index)?.live.clone(),
            count: *self.counts.zones.get(index)?,
            inside: everybody().filter(|(_, p)| is_in(p)).map(|(who, _)| who.subject()).collect(),
            possible: everybody().filter(|(_, p)| may_be(p)).map(|(who, _)| who.subject()).collect(),
        })
    }

    /// How many are where.
    pub fn headcount(&self) -> Headcount {
        let Some(ground) = &self.ground else { return Headcount::default() };
        let zones = ground.watch.shapes().iter().map(|shape| shape.id().to_owned());
        let silent = self.roster.everybody_seen().filter(|(who, presence)| {
            who.is_somebody() && presence.is_below() && !self.is_heard(presence.heard)
        });
        Headcount {
            mine: self.counts.mine,
            levels: self.levels.iter().cloned().zip(self.counts.levels.iter().copied()).collect(),
            zones: zones.zip(self.counts.zones.iter().copied()).collect(),
            out_of_contact: u32::try_from(silent.count()).unwrap_or(u32::MAX),
        }
    }

    /// Open alarms, in the order in which they were raised.
    pub fn open_alarms(&self) -> impl Iterator<Item = &Alarm> {
        self.alarms.open()
    }

    /// The last thousand alarms that were cleared, the latest last.
    pub fn cleared_alarms(&self) -> impl Iterator<Item = &Alarm> {
        self.alarms.cleared()
    }

    /// An alarm that is open or among the last that were cleared.
    pub fn alarm(&self, id: AlarmId) -> Option<&Alarm> {
        self.alarms.find(id)
    }

    /// Gateways and anchors that were ever heard of.
    pub fn devices(&self) -> impl Iterator<Item = DeviceView> + '_ {
        [DeviceKind::Gateway, DeviceKind::Anchor].into_iter().flat_map(|kind| {
            self.devices[kind as usize].iter().map(move |(id, &(up, since))| DeviceView {
                kind,
                id: id.clone(),
                up,
                since,
            })
        })
    }

    /// The evacuation that runs, with everybody concerned.
    pub fn evacuation(&self) -> Option<EvacuationView> {
        let (evacuation, ground) = (self.evacuation.as_ref()?, self.ground.as_ref()?);
        let mut summary = EvacuationSummary::default();
        let mut people = Vec::new();
        for (who, presence) in self.roster.everybody_seen() {
            let Some(Mark { since, way_m, missing, .. }) = presence.evacuation else { continue };
            let status = evacuation.status(presence, self.now, ground, &self.rules);
            let missing = missing && !status.is_safe();
            summary.add(status, missing);
            let last_known = self.presence_seen(presence);
            let safe = matches!(status, EvacuationStatus::Out | EvacuationStatus::InRefuge);
            let place = last_known.as_ref().map(|known| known.position_m).filter(|_| !safe);
            let nearest = place.map(|place| ground.exits.nearest(&ground.mine, &place)).unwrap_or_default();
            people.push(Evacuee {
                subject: who.subject(),
                status,
                since,
                missing,
                last_known,
                nearer_by_m: way_m.zip(nearest.length_m()).map(|(before, now)| before - now),
                to_refuge: nearest.refuge,
                to_portal: nearest.portal,
            });
        }
        Some(EvacuationView {
            id: evacuation.id,
            since: evacuation.since,
            running: self.now.since(evacuation.since),
            by: evacuation.by.clone(),
            note: evacuation.note.clone(),
            levels: evacuation.levels.clone(),
            summary,
            people,
        })
    }
}
