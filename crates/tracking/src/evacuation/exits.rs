//! The ways to every refuge and out, searched once for every set of zones.

use super::status::Way;
use crate::zones::LiveZone;
use adit_core::frames::{MineGrid, Position};
use adit_mine::Mine;
use adit_mine::network::{Travel, Ways};
use adit_mine::plan::ZoneKind;
use std::collections::BTreeMap;

/// The refuges and portals with the ways to each.
#[derive(Debug, Clone, Default)]
pub struct Exits(Vec<Exit>);

#[derive(Debug, Clone)]
struct Exit {
    zone: String,
    kind: ZoneKind,
    ways: Ways,
}

/// The shortest ways from somewhere.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Nearest {
    pub refuge: Option<Way>,
    pub portal: Option<Way>,
}

impl Nearest {
    /// Length of the shorter one, m.
    pub fn length_m(&self) -> Option<f64> {
        let lengths = [&self.refuge, &self.portal].into_iter().flatten().map(|way| way.length_m);
        lengths.reduce(f64::min)
    }
}

impl Exits {
    pub fn new(mine: &Mine, zones: &BTreeMap<String, LiveZone>) -> Self {
        let exits = zones.values().map(|live| &live.zone);
        let exits = exits.filter(|zone| matches!(zone.kind, ZoneKind::Refuge | ZoneKind::Portal));
        let exit = |zone: &adit_mine::plan::Zone| Exit {
            zone: zone.id.clone(),
            kind: zone.kind,
            ways: mine.network().ways_to(&mine.spots_in(zone), Travel::OnFoot),
        };
        Self(exits.map(exit).collect())
    }

    /// The shortest ways from the roadway that is nearest to a point.
    pub fn nearest(&self, mine: &Mine, from: &Position<MineGrid>) -> Nearest {
        let Some(foot) = mine.network().nearest(from) else { return Nearest::default() };
        let shortest = |kind: ZoneKind| {
            let ways = self.0.iter().filter(|exit| exit.kind == kind);
            let ways = ways.filter_map(|exit| Some((exit, exit.ways.length_m(mine.network(), &foot.spot)?)));
            ways.min_by(|a, b| a.1.total_cmp(&b.1))
                .map(|(exit, length_m)| Way { zone: exit.zone.clone(), length_m })
        };
        Nearest { refuge: shortest(ZoneKind::Refuge), portal: shortest(ZoneKind::Portal) }
    }
}
