#![expect(clippy::unwrap_used, reason = "a test may fail by panicking")]

use super::{Pipeline, PipelineSettings, Profile, Profiles, Started};
use crate::journal::{Committed, Committer, GatewayBatch, Numbered, UserCommand, What};
use adit_core::time::{Interval, Time};
use adit_estimation::methods::fused::FusedParams;
use adit_estimation::methods::{Known, MethodSettings, Worn};
use adit_estimation::radio::RadioSite;
use adit_estimation::weighed::{Weighed, WeighedKind};
use adit_mine::Mine;
use adit_nlos::Model;
use adit_observation::sidecar::Sidecar;
use adit_observation::wire::{Batch, Packet, Resolution};
use adit_observation::{DeviceId, Observation, ObservationKind};
use adit_simulation::Foot;
use adit_simulation::people::{Belt, PersonSpec, Place, Roam};
use adit_simulation::radio::RangeDetail;
use adit_simulation::workforce::{Mount, Outfit, Workforce, WorkforceSpec};
use adit_tracking::{Command, Person, Rules, Tag};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicI64, AtomicU64, Ordering};
use std::sync::mpsc::Receiver;
use std::time::Duration;

const LENGTH_S: i32 = 40;
/// When the log begins, ns since the Unix epoch.
const EPOCH_NS: i64 = 1_795_000_000_000_000_000;
const SECOND_NS: i64 = 1_000_000_000;

fn two_level() -> Arc<Mine> {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../mines/two-level.toml");
    Arc::new(adit_mine::file::open(Path::new(file)).unwrap().0)
}

/// A walk of a tag, with ranges.
fn walk(mine: &Arc<Mine>, mount: Mount, seed: u64) -> Vec<Observation> {
    let length_s = f64::from(LENGTH_S);
    let start = Place::Roadway { id: "l300-haulage".to_owned(), along_m: 320.0, left_m: 0.0 };
    let roam = Roam::on_level("l300", length_s, 200.0, 0.0, [5.0, 10.0]);
    let person = PersonSpec::roaming(start, 4.0, roam);
    let mut outfit = Outfit::plain(mount, 2.0);
    outfit.radio.detail = RangeDetail::Diagnostics;
    let spec = WorkforceSpec::undisturbed(length_s, vec![person], outfit);
    let workforce = Workforce::new(Arc::clone(mine), spec, seed).unwrap();
    workforce.stream(0).unwrap().unwrap().map(|emission| emission.observation()).collect()
}

fn profiles(mine: &Arc<Mine>) -> Arc<Profiles> {
    let site = Arc::new(RadioSite::of_mine(mine));
    let profile = |name: &str, tags: &str, worn| {
        let known = Known { worn: Some(worn), ..Known::default() };
        let settings = FusedParams::default().knowing(&known).at_site(&site);
        Profile::new(name, vec![tags.to_owned()], Sidecar::default(), settings.into())
    };
    let judge = Arc::new(Model::named("mine").unwrap().unwrap());
    let belts = profile("belts", "belt-*", Worn::Body).judging(judge);
    Arc::new(Profiles::new(vec![belts, profile("feet", "foot-*", Worn::Foot)]).unwrap())
}

fn settings(mine: &Arc<Mine>, folder: &Path, stored: &Arc<AtomicU64>) -> PipelineSettings {
    PipelineSettings {
        mine: Arc::clone(mine),
        profiles: profiles(mine),
        rules: Rules::default(),
        shards: 2,
        folder: folder.to_path_buf(),
        // There is always one under way.
        snapshot_every: Duration::ZERO,
        stored: Arc::clone(stored),
    }
}

/// What happens, second by second: when it arrives and what.
fn story(mine: &Arc<Mine>) -> Vec<(Time, What)> {
    let walks = [
        ("belt-1", walk(mine, Mount::Belt(Belt::front()), 1)),
        ("belt-2", walk(mine, Mount::Belt(Belt::front()), 2)),
        ("foot-1", walk(mine, Mount::RightFoot(Foot::instep()), 3)),
    ];
    let command = |command: Command| {
        let command = serde_json::to_string(&command).unwrap();
        What::Command(UserCommand { actor: "test".to_owned(), command })
    };
    let at = |second: i64, ns: i64| Time::from_nanos(EPOCH_NS + second * SECOND_NS + ns);
    let person = Person { id: "anna".to_owned(), name: "Anna".to_owned(), ..Person::default() };
    let tag = Tag { id: "belt-1".to_owned(), ..Tag::default() };
    let mut story = vec![
        (at(0, 1), command(Command::CreatePerson { person })),
        (at(0, 2), command(Command::CreateTag { tag })),
    ];
    for second in 0..i64::from(LENGTH_S) {
        let (from, until) = (second * SECOND_NS, (second + 1) * SECOND_NS);
        for (index, (tag, walk)) in (0_i64..).zip(&walks) {
            let within = |o: &&Observation| (from..until).contains(&o.time().nanos());
            let moved = |o: &Observation| o.clone().at(o.time() + Interval::from_nanos(EPOCH_NS));
            let packet = Packet {
                tag: DeviceId::new(tag).unwrap(),
                number: (second + 1).unsigned_abs(),
                battery: Some(0.9),
                distress: second == 20 && index == 1,
                observations: walk.iter().filter(within).map(moved).collect(),
            };
            let batch =
                Batch::new(7, (1 + second).unsigned_abs()).with_packet(&packet, &Resolution::default());
            let gateway = format!("gw-{index}");
            let batch = GatewayBatch { gateway, batch: batch.to_bytes().into() };
            story.push((at(second + 1, 100_000_000 + index), What::Batch(batch)));
        }
        story.push((at(second + 1, 900_000_000), What::Tick(())));
        if second == 10 {
            let assign = Command::Assign {
                tag: "belt-1".to_owned(),
                person: "anna".to_owned(),
                from: None,
                until: None,
            };
            story.push((at(second + 1, 950_000_000), command(assign)));
        }
    }
    story
}

/// A server of this test: pipeline and journal in a folder, a clock that is set by hand.
struct Server {
    pipeline: Pipeline,
    committer: Committer,
    groups: Receiver<Vec<Committed>>,
    journal: std::thread::JoinHandle<()>,
    clock: Arc<AtomicI64>,
    stored: Arc<AtomicU64>,
    told: Vec<String>,
}

impl Server {
    fn start(mine: &Arc<Mine>, folder: &Path, stored: u64) -> Self {
        let stored = Arc::new(AtomicU64::new(stored));
        let Started { mut pipeline, journal, from, mut gateways } =
            Pipeline::open(settings(mine, folder, &stored)).unwrap();
        let mut told = Vec::new();
        pipeline.replay((&journal, from), &mut gateways, |o| told.extend(lines(&o)), |_| {}).unwrap();
        let clock = Arc::new(AtomicI64::new(0));
        let hand = Arc::clone(&clock);
        let now = move || Time::from_nanos(hand.load(Ordering::SeqCst));
        let (committer, groups, journal) =
            Committer::start(journal, gateways.1, now, Arc::default()).unwrap();
        Self { pipeline, committer, groups, journal, clock, stored, told }
    }

    /// Stores one thing and takes it; `false` when it had come before.
    fn take(&mut self, runtime: &tokio::runtime::Runtime, (time, what): &(Time, What)) -> bool {
        self.clock.store(time.nanos(), Ordering::SeqCst);
        let number = match what {
            What::Batch(batch) => {
                let batch = Batch::read(batch.batch.clone()).unwrap();
                Some(Numbered { boot: batch.boot, sequence: batch.sequence })
            }
            _ => None,
        };
        let appended = runtime.block_on(self.committer.append(what.clone(), number)).unwrap();
        if appended == crate::journal::Appended::Repeated {
            return false;
        }
        let outcome = self.pipeline.round(self.groups.recv().unwrap());
        self.told.extend(lines(&outcome));
        // The snapshot goes on in small steps, so that tags in it are of different moments.
        self.pipeline.keep(&self.committer);
        true
    }

    /// As if the power went: nothing is written any more.
    fn die(self) -> Vec<String> {
        let Self { committer, groups, journal, told, .. } = self;
        drop((committer, groups));
        journal.join().unwrap();
        told
    }

    fn state(&self) -> String {
        let tracking = self.pipeline.tracking();
        let tracking = serde_json::to_string_pretty(&*tracking.read().unwrap()).unwrap();
        let health =
            ["belt-1", "belt-2", "foot-1"].map(|tag| format!("{:?}", self.pipeline.health(tag).unwrap()));
        format!("{tracking}\n{}", health.join("\n"))
    }
}

/// The first line in which two runs differ, cut to what a reader can bear.
fn same(found: &[String], expected: &[String]) {
    let differs = found.iter().zip(expected).position(|(found, expected)| found != expected);
    let at = differs.unwrap_or(found.len().min(expected.len()));
    let line = |lines: &[String]| lines.get(at).map(|line| line.chars().take(600).collect::<String>());
    assert!(
        found == expected,
        "{} and {} lines; line {at}:\n{:?}\n{:?}",
        found.len(),
        expected.len(),
        line(found),
        line(expected)
    );
}

fn lines(outcome: &super::RoundOutcome) -> Vec<String> {
    let fixes = outcome.fixes.iter().map(|fix| format!("{fix:?}"));
    fixes.chain(outcome.events.iter().map(|event| format!("{event:?}"))).collect()
}

/// Both walk among the same anchors, the belt with a judge, the foot without.
fn tells_whom_it_hears(server: &Server) {
    let health = |tag: &str| server.pipeline.health(tag).unwrap();
    for (tag, judged) in [("belt-1", true), ("foot-1", false)] {
        let health = health(tag);
        assert_eq!(health.judged, judged, "{tag}");
        let ranges = health.heard.sources.iter().filter(|(source, _)| source.kind == WeighedKind::Range);
        let ranges: Vec<_> = ranges.collect();
        assert!(ranges.len() >= 3, "{tag}: {:?}", health.heard.sources);
        for (source, weighed) in ranges {
            assert_eq!(source.line_of_sight.is_some(), judged, "{tag}: {source:?}");
            assert!((0.0..300.0).contains(&source.value), "{tag}: {source:?}");
            // A range that counted in full is off by no more than corridors are wide, squared over its own variance within the gate.
            let fits =
                |weighed: &Weighed| !weighed.believed || weighed.residual.abs() < 5.0 && weighed.nis < 25.0;
            assert!(weighed.as_ref().is_none_or(fits), "{tag}: {weighed:?}");
        }
        let weighed = health.heard.sources.iter().filter(|(_, weighed)| weighed.is_some()).count();
        assert!(weighed >= 3, "{tag}: {:?}", health.heard.sources);
        let counted: u64 = health.heard.course.iter().map(|bin| bin.count).sum();
        assert!(counted > 30 && health.heard.course.len() == 60, "{tag}: {counted}");
        let imu = health.heard.sensors.iter().find(|rate| rate.kind == ObservationKind::Imu);
        assert!(imu.is_some_and(|rate| rate.per_s > 20.0), "{tag}: {:?}", health.heard.sensors);
    }
}

#[test]
fn a_server_that_dies_again_and_again_ends_where_one_that_does_not_ends() {
    let mine = two_level();
    let story = story(&mine);
    let runtime = tokio::runtime::Builder::new_current_thread().build().unwrap();

    let whole_folder = tempfile::tempdir().unwrap();
    let mut whole = Server::start(&mine, whole_folder.path(), 0);
    for event in &story {
        assert!(whole.take(&runtime, event));
    }
    assert!(whole.told.len() > 70, "{} lines", whole.told.len());
    let judged = |tag: &str| whole.pipeline.health(tag).unwrap().counts.judged;
    assert!(judged("belt-1") > 50 && judged("foot-1") == 0, "{}", judged("belt-1"));
    tells_whom_it_hears(&whole);

    let folder = tempfile::tempdir().unwrap();
    let mut server = Server::start(&mine, folder.path(), 0);
    let mut told = Vec::new();
    for (index, event) in story.iter().enumerate() {
        if index % 23 == 5 {
            let stored = server.pipeline.position();
            told.extend(server.die());
            // What had been told is in the store; the journal tells the rest.
            server = Server::start(&mine, folder.path(), stored);
        }
        assert!(server.take(&runtime, event), "{index}");
        server.stored.store(server.pipeline.position(), Ordering::Release);
        // Sent again since the acknowledgement was lost: known, also after a restart.
        if matches!(event.1, What::Batch(_)) {
            assert!(!server.take(&runtime, event), "{index}");
        }
    }
    let state = |server: &Server| server.state().lines().map(ToOwned::to_owned).collect::<Vec<_>>();
    same(&state(&server), &state(&whole));
    told.extend(server.told.clone());
    same(&told, &whole.told);
    let kept = std::fs::read_dir(folder.path().join("snapshots")).unwrap().count();
    assert!((1..=2).contains(&kept), "{kept} files");
}

#[test]
fn what_the_store_did_not_get_it_gets_after_the_restart() {
    let mine = two_level();
    let story = story(&mine);
    let runtime = tokio::runtime::Builder::new_current_thread().build().unwrap();
    let folder = tempfile::tempdir().unwrap();
    let mut server = Server::start(&mine, folder.path(), 0);
    let (mut stored, mut lines_stored) = (0, 0);
    for (index, event) in story.iter().enumerate() {
        server.take(&runtime, event);
        // The store keeps up for a while and then no more: a snapshot must wait for it.
        if index <= 60 {
            (stored, lines_stored) = (server.pipeline.position(), server.told.len());
            server.stored.store(stored, Ordering::Release);
        }
    }
    let told = server.die();
    let again = Server::start(&mine, folder.path(), stored);
    // Fixes and events of a round stand apart, and rounds are other ones.
    let sorted = |lines: &[String]| {
        let mut lines = lines.to_vec();
        lines.sort();
        lines
    };
    same(&sorted(&again.told), &sorted(&told[lines_stored..]));
    assert!(again.told.len() > 50, "{}", again.told.len());
}

#[test]
fn a_batch_with_several_packets_of_a_tag_is_taken_whole_also_after_a_restart() {
    let mine = two_level();
    let walk = walk(&mine, Mount::Belt(Belt::front()), 1);
    let packet = |second: i64| {
        let (from, until) = (second * SECOND_NS, (second + 1) * SECOND_NS);
        let within = |o: &&Observation| (from..until).contains(&o.time().nanos());
        let moved = |o: &Observation| o.clone().at(o.time() + Interval::from_nanos(EPOCH_NS));
        Packet {
            tag: DeviceId::new("belt-1").unwrap(),
            number: (second + 1).unsigned_abs(),
            battery: None,
            distress: false,
            observations: walk.iter().filter(within).map(moved).collect(),
        }
    };
    // A gateway that was cut off sends what it has kept.
    let backlog = |sequence: u64, seconds: std::ops::Range<i64>| {
        let arrived = Time::from_nanos(EPOCH_NS + seconds.end * SECOND_NS);
        let batch = seconds.fold(Batch::new(7, sequence), |batch, second| {
            batch.with_packet(&packet(second), &Resolution::default())
        });
        let batch = GatewayBatch { gateway: "gw".to_owned(), batch: batch.to_bytes().into() };
        (arrived, What::Batch(batch))
    };
    let runtime = tokio::runtime::Builder::new_current_thread().build().unwrap();
    let folder = tempfile::tempdir().unwrap();
    let mut server = Server::start(&mine, folder.path(), 0);
    let numbers = |server: &Server| server.pipeline.health("belt-1").unwrap().packet_numbers;
    assert!(server.take(&runtime, &backlog(1, 0..4)));
    assert_eq!(numbers(&server), [(1, 4)]);
    server.die();
    let mut server = Server::start(&mine, folder.path(), 0);
    assert_eq!(numbers(&server), [(1, 4)]);
    assert!(server.take(&runtime, &backlog(2, 4..9)));
    assert_eq!(numbers(&server), [(1, 9)]);
}
