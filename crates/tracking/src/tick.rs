//! What a second brings: silence, delays, limits, escalation.

use crate::alarms::{About, AlarmKey, AlarmKind};
use crate::event::Event;
use crate::time::seconds;
use crate::tracking::Tracking;

impl Tracking {
    pub(crate) fn tick(&mut self, events: &mut Vec<Event>) {
        self.listen(events);
        if self.roster.next_change.is_some_and(|change| self.now >= change) {
            let tags: Vec<String> = self.roster.tags.keys().cloned().collect();
            for tag in tags {
                self.settle(&tag, events);
            }
            self.roster.schedule(self.now);
        }
        // Of two tags that one is worn which is heard.
        let several = self.roster.people.iter().filter(|(_, record)| record.tags.len() > 1);
        let several: Vec<String> = several.map(|(id, _)| id.clone()).collect();
        for person in several {
            self.roster.choose_lead(&person, self.now - seconds(self.rules.contact.lost_after_s));
        }
        let (listening, evacuation, silent) =
            (self.listening.since, self.evacuation.clone(), self.listening.silent);
        let Some((mut stage, roster)) = self.stage(events) else { return };
        for (who, presence) in roster.everybody() {
            // While nothing is heard of anybody, nobody in particular is lost.
            let listening = if silent { stage.now } else { listening };
            stage.second(&who, presence, listening);
            let Some(evacuation) = evacuation.as_ref().filter(|_| who.is_somebody()) else { continue };
            let was_missing = presence.evacuation.as_ref().is_some_and(|mark| mark.missing);
            let is_missing = evacuation.follow(presence, stage.now, stage.ground, stage.rules);
            if is_missing && !was_missing {
                let since = presence.heard.unwrap_or(stage.now);
                stage.begin(&who, presence, AlarmKind::MissingInEvacuation, None, since);
            } else if was_missing && !is_missing {
                stage.end(&who, AlarmKind::MissingInEvacuation, None);
            }
        }
        self.alarms.tick(self.now, &self.rules, events);
    }

    /// Is anything heard at all?
    fn listen(&mut self, events: &mut Vec<Event>) {
        let (now, rules) = (self.now, &self.rules.contact);
        let listening = &mut self.listening;
        let gap = listening.last_tick.is_none_or(|last| now.since(last) > seconds(rules.tick_gap_s));
        listening.last_tick = Some(now);
        if gap {
            listening.since = now;
        }
        let heard = listening.last_heard.map_or(listening.since, |heard| heard.max(listening.since));
        let enough = self.counts.mine.heads() >= rules.silence_from_people;
        // Whoever came out meanwhile does not end it: only a voice does.
        let silent = (enough || listening.silent) && now.since(heard) > seconds(rules.silence_after_s);
        if silent == listening.silent {
            return;
        }
        listening.silent = silent;
        let key = AlarmKey { kind: AlarmKind::Silence, about: About::Mine, zone: None };
        if silent {
            self.alarms.begin(now, key, (heard, None), &self.rules, events);
        } else {
            self.listening.since = now;
            self.alarms.end(now, &key, &self.rules, events);
        }
    }
}
