//! Ranges judged on their way into a method.
//!
//! What has a [`adit_observation::Reception`] gets its [`RangeSample::line_of_sight`], and [`RangeSample::in_the_way`] by a model that tells it; what was there is written over. Other ranges stay as
//! they are. What was told of a link before counts ([`LinkFilter`]).

use crate::link_filter::{LinkFilter, Persistence};
use crate::model::Model;
use crate::network::Scratch;
use crate::task::Task;
use adit_observation::{DeviceId, Radio, RangeSample};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Links that are kept in mind; past that all are forgotten.
const MOST_LINKS: usize = 4096;

/// What was told of links so far, by tag and anchor; of one tag or of a whole log. It can be kept and read back.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Links(BTreeMap<(Option<DeviceId>, DeviceId), LinkFilter>);

impl Links {
    /// True where nothing was judged yet.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}

/// Judges a range of one of these links; `false` where nothing tells how its signal came in, or it is of another radio.
pub fn annotate(range: &mut RangeSample, model: &Model, links: &mut Links, scratch: &mut Scratch) -> bool {
    if !matches!(range.radio, Radio::Uwb | Radio::Unknown) {
        return false;
    }
    let Some(reception) = range.reception.as_deref() else { return false };
    let told = model.judge(reception, Some(range.range_m), scratch);
    let Links(links) = links;
    if links.len() >= MOST_LINKS {
        links.clear();
    }
    let link = (range.tag.clone(), range.anchor.clone());
    let filter = links.entry(link).or_insert_with(|| LinkFilter::new(model, Persistence::default()));
    let believed = filter.update(range.time, &told);
    range.line_of_sight = Some(f64::from(believed[0].clamp(0.0, 1.0)));
    range.in_the_way = (model.task == Task::InTheWay).then_some(believed);
    true
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "tests")]
mod tests {
    use super::*;
    use adit_core::time::Time;
    use adit_observation::{DeviceId, Reception};
    use std::sync::Arc;

    /// A range whose first path is so much below the whole signal, dB.
    fn range(below: f32) -> RangeSample {
        let reception = Reception {
            rx_power_dbm: Some(-80.0),
            first_path_power_dbm: Some(-80.0 - below),
            preamble_count: Some(300),
            ..Reception::default()
        };
        RangeSample {
            time: Time::ZERO,
            anchor: DeviceId::new("a1").unwrap(),
            tag: None,
            range_m: 4.0,
            sigma_m: None,
            line_of_sight: None,
            in_the_way: None,
            radio: Radio::Uwb,
            reception: Some(Arc::new(reception)),
        }
    }

    #[test]
    fn a_range_gets_what_the_model_says_of_its_reception() {
        let model = Model::shipped().unwrap();
        let told = |below: f32| {
            let mut range = range(below);
            assert!(annotate(&mut range, &model, &mut Links::default(), &mut Scratch::default()));
            let reception = range.reception.as_deref().unwrap();
            let expected = model.judge(reception, Some(4.0), &mut Scratch::default())[0];
            let found = range.line_of_sight.unwrap();
            assert!((found - f64::from(expected)).abs() < 1e-6, "{found} {expected}");
            found
        };
        assert!(told(2.0) > told(12.0));
    }

    #[test]
    fn what_nothing_is_told_of_stays_as_it_was() {
        let model = Model::shipped().unwrap();
        let bare = RangeSample { reception: None, line_of_sight: Some(0.25), ..range(2.0) };
        let wifi = RangeSample { radio: Radio::Wifi, ..range(2.0) };
        for before in [bare, wifi] {
            let mut after = before.clone();
            assert!(!annotate(&mut after, &model, &mut Links::default(), &mut Scratch::default()));
            assert_eq!(after, before);
        }
    }
}
