//! A shift, live: people and their tags are simulated second by second, gateways bring what they send to a server, and the story happens.
//!
//! The clock of the mine goes `--speed` times as fast as the wall's, here and in the server. When this machine cannot follow, the clock
//! is slowed and says so: nothing is left out.

use super::browser;
use super::crew::{Crew, GATEWAYS};
use super::gateways::{Gateways, Heard, Target};
use super::host::{self, Host};
use super::score::Score;
use super::story::{ANCHOR, GATEWAY, LONGEST_S, Part, Story, Times};
use super::viewer::{Roll, Viewer};
use crate::args::DemoArgs;
use crate::interrupt;
use crate::output::{self, print};
use adit_core::time::{Interval, Time};
use adit_server::{Clock, Pace};
use adit_simulation::ImuErrorModel;
use anyhow::{Context, Result, bail};
use futures_util::StreamExt as _;
use serde_json::json;
use std::net::{Ipv4Addr, SocketAddr, TcpListener};
use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Where it listens when that is free.
const PORT: u16 = 8080;
/// For so long the server has no power.
const DARK: Duration = Duration::from_secs(1);
/// Between two looks at whether this machine follows.
const LOOK: Duration = Duration::from_secs(1);
/// So far behind, in time of the wall, for so many looks, and the clock is slowed by this.
const BEHIND_S: f64 = 0.8;
const LOOKS: u32 = 3;
/// A position is no older at the viewer: a packet is of a second, and its last step ends in the next, s of the shift.
const ON_TIME_S: f64 = 2.0;
const SLOWER: f64 = 0.8;
/// At the beginning and when something is back this is not judged: there is something to catch up with.
const CATCH_UP: Duration = Duration::from_secs(10);
/// The score is told this often, s of the shift.
const SCORE_S: f64 = 300.0;
/// Requests at once.
const AT_ONCE: usize = 64;
/// How long the end waits for acknowledgements.
const DRAIN: Duration = Duration::from_secs(20);

/// Something that happens at a time of the shift.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Cue {
    Intruder,
    Fall,
    Button,
    GatewayDown,
    GatewayUp,
    AnchorDown,
    AnchorUp,
    Helped,
    PowerCut,
    Battery,
    Evacuation,
    End,
}

fn cues(times: &Times) -> Vec<(f64, Cue)> {
    let mut cues = vec![
        (times.intruder, Cue::Intruder),
        (times.fall, Cue::Fall),
        (times.button, Cue::Button),
        (times.gateway[0], Cue::GatewayDown),
        (times.gateway[1], Cue::GatewayUp),
        (times.anchor[0], Cue::AnchorDown),
        (times.anchor[1], Cue::AnchorUp),
        (times.helped, Cue::Helped),
        (times.power_cut, Cue::PowerCut),
        (times.battery, Cue::Battery),
        (times.evacuation, Cue::Evacuation),
        (times.end, Cue::End),
    ];
    cues.sort_by(|a, b| b.0.total_cmp(&a.0));
    cues
}

/// Runs the shift.
pub fn run(args: &DemoArgs) -> Result<()> {
    let begun = Instant::now();
    let (folder, _kept) = folder(args)?;
    let mine_path = host::write_mine(&folder)?;
    let mine = Arc::new(adit_mine::file::open(&mine_path)?.0);
    let length_s = args.minutes.map_or(LONGEST_S, |minutes| 60.0 * minutes);
    let people = usize::try_from(args.people)?;
    let seed = args.seed.unwrap_or(1);
    let story = Story::new(&mine, people, length_s, seed)?;

    let wall = adit_server::now();
    let clock = Clock::simulated(Pace::REAL.from(wall, args.speed));
    let (listen, pace) = (address(args.listen)?, clock.pace());
    let at = folder.clone();
    let server = std::thread::spawn(move || Host::start(&at, listen, pace, &sidecar()));
    let mut crew = Crew::new(&mine, &story, length_s, seed)?;
    let host =
        server.join().map_err(|_| anyhow::anyhow!("the thread that starts the server has ended"))??;

    let runtime = tokio::runtime::Builder::new_multi_thread().worker_threads(2).enable_all().build()?;
    let target = runtime.block_on(async {
        let target = host.log_in().await?;
        enter(&target, &story).await?;
        Ok::<_, anyhow::Error>(target)
    })?;
    let begin = clock.now();
    crew.begin_at(begin);
    let _inside = runtime.enter();
    let gateways = Gateways::start(&target, &clock, u64::from(std::process::id()));
    let tags = story.members.iter().enumerate().map(|(number, member)| (member.tag.clone(), number));
    let names = story.members.iter().map(|member| (member.id.clone(), member.name.clone()));
    let roll =
        Roll { tags: tags.collect(), names: names.collect(), truth: crew.truth(), mine: Arc::clone(&mine) };
    let viewer = Viewer::start(target.clone(), roll);

    let (url, password) = (&target.url, &host.password);
    print(&format!(
        "A shift of {people} people at {:.0} times real time, live: {url}\nuser admin, password {password}\n",
        args.speed
    ))?;
    if !args.no_browser {
        browser::open(&format!("{url}/#login=admin:{password}"));
    }
    let cues = cues(&story.times);
    let mut shift = Shift {
        story,
        clock,
        begin,
        crew,
        gateways,
        viewer,
        target,
        host,
        runtime: &runtime,
        cues,
        power_back: None,
        looks: Looks { next: begun + LOOK, late: 0, not_before: Instant::now() + CATCH_UP },
        scored: (0, SCORE_S),
        missing_since: None,
        slowest: args.speed,
        observations: 0,
        begun: Some(begun),
    };
    shift.tell("the shift begins")?;
    let ended = shift.go(length_s);
    // The same Ctrl-C ends the server: what it did not answer any more is no error.
    let ended = if interrupt::check().is_err() { Ok(()) } else { ended };
    let told = shift.end(ended.is_ok());
    ended.and(told)
}

/// The folder of everything; a temporary one is removed at the end.
fn folder(args: &DemoArgs) -> Result<(PathBuf, Option<tempfile::TempDir>)> {
    if let Some(out) = &args.out {
        output::make_folder(out)?;
        if out.join("data").exists() {
            bail!("{}: there is a shift already; name a new folder", out.display());
        }
        return Ok((out.clone(), None));
    }
    let folder = tempfile::Builder::new().prefix("adit-demo-").tempdir().context("no temporary folder")?;
    Ok((folder.path().to_path_buf(), Some(folder)))
}

/// Where to listen: as asked, else at the usual port, else where it is free.
fn address(asked: Option<SocketAddr>) -> Result<SocketAddr> {
    if let Some(asked) = asked {
        return Ok(asked);
    }
    let usual = SocketAddr::from((Ipv4Addr::LOCALHOST, PORT));
    let any = SocketAddr::from((Ipv4Addr::LOCALHOST, 0));
    let free = TcpListener::bind(usual).or_else(|_| TcpListener::bind(any)).context("no port is free")?;
    Ok(free.local_addr()?)
}

/// What is known of the tags: worn in front, x forward and z up, an MPU-6050.
fn sidecar() -> String {
    let noise = ImuErrorModel::mpu6050().specification();
    format!(
        "[mounting]\nlocation = \"waist\"\nrotation = \"x-forward, y-left, z-up\"\n\n[noise]\n\
         angle_random_walk_rad_sqrt_s = {:e}\nvelocity_random_walk_m_s_sqrt_s = {:e}\n\
         gyro_bias_walk_rad_s_sqrt_s = {:e}\nacc_bias_walk_m_s2_sqrt_s = {:e}\n",
        noise.angle_random_walk_rad_sqrt_s,
        noise.velocity_random_walk_m_s_sqrt_s,
        noise.gyro_bias_walk_rad_s_sqrt_s,
        noise.acc_bias_walk_m_s2_sqrt_s,
    )
}

/// Enters people and tags, and who wears which, as an administrator would.
async fn enter(target: &Target, story: &Story) -> Result<()> {
    let all = futures_util::stream::iter(&story.members).map(|member| async move {
        let person = json!({ "id": member.id, "name": member.name, "team": member.team, "shift": "early" });
        target.ask("POST", "/api/v1/people", Some(person)).await?;
        target.ask("POST", "/api/v1/tags", Some(json!({ "id": member.tag, "worn": "waist" }))).await?;
        let path = format!("/api/v1/tags/{}/assignments", member.tag);
        target.ask("POST", &path, Some(json!({ "person": member.id }))).await.map(drop)
    });
    let mut all = all.buffer_unordered(AT_ONCE);
    while let Some(entered) = all.next().await {
        entered?;
    }
    Ok(())
}

/// Whether this machine follows.
struct Looks {
    next: Instant,
    late: u32,
    not_before: Instant,
}

struct Shift<'a> {
    story: Story,
    clock: Clock,
    begin: Time,
    crew: Crew,
    gateways: Gateways,
    viewer: Viewer,
    target: Target,
    host: Host,
    runtime: &'a tokio::runtime::Runtime,
    /// The last comes first.
    cues: Vec<(f64, Cue)>,
    power_back: Option<Instant>,
    looks: Looks,
    /// Positions that have been told of, and when the next are, s.
    scored: (usize, f64),
    /// People are to be found again since then.
    missing_since: Option<Instant>,
    slowest: f64,
    observations: u64,
    /// When this program was started; until the first positions are told.
    begun: Option<Instant>,
}

impl Shift<'_> {
    fn now_s(&self) -> f64 {
        (self.clock.now() - self.begin).seconds()
    }

    fn tell(&self, text: &str) -> Result<()> {
        tell_at(self.now_s(), text)
    }

    fn go(&mut self, length_s: f64) -> Result<()> {
        while self.crew.seconds() < length_s {
            if interrupt::check().is_err() {
                return Ok(());
            }
            if self.crew.seconds() + 1.0 <= self.now_s() {
                self.second();
            } else {
                std::thread::sleep(Duration::from_millis(5));
            }
            while let Some((_, cue)) = self.cues.pop_if(|(time, _)| *time <= self.crew.seconds()) {
                self.happen(cue)?;
            }
            if self.power_back.is_some_and(|back| back <= Instant::now()) {
                self.power_is_back()?;
            }
            self.report()?;
            if Instant::now() >= self.looks.next {
                self.look()?;
            }
        }
        Ok(())
    }

    /// A second of everybody, to the gateways.
    fn second(&mut self) {
        let second_s = self.crew.seconds();
        let mut heard = vec![Heard::default(); GATEWAYS.len()];
        for sent in self.crew.next_second() {
            self.observations += sent.observations as u64;
            heard[sent.gateway].packets.push(sent.packet);
        }
        let times = &self.story.times;
        for (time, up) in [(times.anchor[0], false), (times.anchor[1], true)] {
            if (second_s..second_s + 1.0).contains(&time) {
                heard[0].anchor = Some((ANCHOR, up));
            }
        }
        for (number, mut heard) in heard.into_iter().enumerate() {
            let [from, until] = times.gateway;
            if GATEWAYS[number] == GATEWAY && (from..until).contains(&second_s) {
                heard.not_before = Interval::from_seconds(until).map(|until| self.begin + until);
            }
            self.gateways.hear(number, heard);
        }
    }

    fn happen(&mut self, cue: Cue) -> Result<()> {
        let who = |part: Part| {
            let member = self.story.members.iter().find(|member| member.part == part);
            member.map_or_else(String::new, |member| format!("{} ({})", member.name, member.id))
        };
        match cue {
            Cue::Intruder => self.tell(&format!("{} sets out for the explosives", who(Part::Intrudes))),
            Cue::Fall => self.tell(&format!("{} falls", who(Part::Falls))),
            Cue::Button => self.tell(&format!("{} has seen it and presses the button", who(Part::Witness))),
            Cue::Helped => self.tell(&format!("{} is up again", who(Part::Falls))),
            Cue::GatewayDown => self.tell(&format!("{GATEWAY} is cut off; it keeps what it hears")),
            Cue::GatewayUp => {
                self.looks.not_before = Instant::now() + CATCH_UP;
                self.tell(&format!("{GATEWAY} is back and sends what it has kept"))
            }
            Cue::AnchorDown => self.tell(&format!("anchor {ANCHOR} has no power")),
            Cue::AnchorUp => self.tell(&format!("anchor {ANCHOR} is back")),
            Cue::PowerCut => {
                self.host.cut_power()?;
                self.power_back = Some(Instant::now() + DARK);
                self.tell("power cut: the server is gone (killed); gateways keep what they hear")
            }
            Cue::Battery => self.tell(&format!("the battery of {} is empty", who(Part::Silent))),
            Cue::Evacuation => {
                let note = json!({ "note": "smoke on the 300 m level" });
                let asked = self.target.ask("POST", "/api/v1/evacuation", Some(note));
                self.runtime.block_on(asked)?;
                self.tell("evacuation: everybody to the refuges or out")
            }
            Cue::End => {
                self.tell_board()?;
                self.tell("the story is over; Ctrl-C ends the shift")
            }
        }
    }

    fn power_is_back(&mut self) -> Result<()> {
        self.power_back = None;
        let begun = Instant::now();
        self.host.restart(self.clock.pace(), &sidecar())?;
        self.looks.not_before = Instant::now() + CATCH_UP;
        self.viewer.seen().found.clear();
        self.missing_since = Some(Instant::now());
        self.tell(&format!("power is back; the server is up after {:.1} s", begun.elapsed().as_secs_f64()))
    }

    /// Tells what has come from the server.
    fn report(&mut self) -> Result<()> {
        let raised = std::mem::take(&mut self.viewer.seen().raised);
        for raised in raised {
            let (kind, severity, about) = (&raised.kind, &raised.severity, &raised.about);
            tell_at((raised.time - self.begin).seconds(), &format!("  alarm, {severity}: {kind}: {about}"))?;
        }
        if let Some(begun) = self.begun.filter(|_| !self.viewer.seen().found.is_empty()) {
            self.begun = None;
            let seconds = begun.elapsed().as_secs_f64();
            self.tell(&format!(
                "first positions at the viewer, {seconds:.1} s after the start of this program"
            ))?;
        }
        if let Some(since) = self.missing_since {
            let sending = self.crew.sending();
            let found = self.viewer.seen().found.len();
            if found >= sending {
                self.missing_since = None;
                let seconds = since.elapsed().as_secs_f64();
                self.tell(&format!(
                    "all {sending} people whose tags send are found again, {seconds:.1} s after that"
                ))?;
            }
        }
        let (from, due_s) = self.scored;
        if self.crew.seconds() >= due_s {
            let (figures, upto) = of(&self.viewer.seen().score, from);
            self.scored = (upto, due_s + SCORE_S);
            if let Some(figures) = figures {
                self.tell(&figures)?;
            }
        }
        Ok(())
    }

    /// Slows the clock when this machine is behind.
    fn look(&mut self) -> Result<()> {
        let now = Instant::now();
        self.looks.next = now + LOOK;
        if self.power_back.is_none() && self.host.has_ended() {
            bail!("the server has ended by itself");
        }
        let [from, until] = self.story.times.gateway;
        if now < self.looks.not_before
            || self.power_back.is_some()
            || (from..until + 1.0).contains(&self.crew.seconds())
        {
            self.looks.late = 0;
            return Ok(());
        }
        let speed = self.clock.pace().speed;
        // Whatever is slow, the simulation, the way or the server: positions are late by it.
        let newest = self.viewer.seen().newest.unwrap_or(self.begin);
        let behind_s = ((self.clock.now() - newest).seconds() - ON_TIME_S).max(0.0) / speed;
        self.looks.late = if behind_s > BEHIND_S { self.looks.late + 1 } else { 0 };
        if self.looks.late < LOOKS || speed <= 1.0 {
            return Ok(());
        }
        self.looks.late = 0;
        let slower = (SLOWER * speed).max(1.0);
        let asked = self.target.ask("PUT", "/api/v1/clock", Some(json!({ "clock_speed": slower })));
        self.runtime.block_on(asked)?;
        self.clock.set_speed(slower);
        self.slowest = slower;
        self.tell(&format!(
            "this machine is {behind_s:.1} s behind: the shift goes on at {slower:.1} times real time, nothing is left out"
        ))
    }

    /// How many packets the server has.
    fn came(&self) -> Result<u64> {
        let came = self.runtime.block_on(self.target.ask("GET", "/api/v1/packets", None))?;
        let tags = came.as_array().into_iter().flatten();
        let spans = tags.filter_map(|tag| tag["numbers"].as_array()).flatten();
        let length = |span: &serde_json::Value| Some(span[1].as_u64()? + 1 - span[0].as_u64()?);
        Ok(spans.filter_map(length).sum())
    }

    /// How everybody stands in the evacuation.
    fn tell_board(&self) -> Result<()> {
        let board = self.runtime.block_on(self.target.ask("GET", "/api/v1/evacuation", None))?;
        let summary = &board["evacuation"]["summary"];
        let of = |name: &str| summary[name].as_u64().unwrap_or(0);
        self.tell(&format!(
            "evacuation board: {} in refuges, {} out, {} on the way, {} not moving, {} not heard of; {} missing",
            of("in_refuge"),
            of("out"),
            of("moving_out"),
            of("not_moving"),
            of("unknown"),
            of("missing")
        ))
    }

    /// The last words; `whole`: nothing went wrong.
    fn end(mut self, whole: bool) -> Result<()> {
        let until = Instant::now() + DRAIN;
        let asked_to_stop = interrupt::check().is_err();
        while whole && !asked_to_stop && self.gateways.account.waiting() > 0 && Instant::now() < until {
            std::thread::sleep(Duration::from_millis(20));
        }
        if whole && !asked_to_stop {
            self.report()?;
            let acknowledged = self.gateways.account.acknowledged.load(std::sync::atomic::Ordering::Relaxed);
            let mut came = self.came()?;
            // What is on the disk is taken a moment later.
            while came < acknowledged && Instant::now() < until {
                std::thread::sleep(LOOK);
                came = self.came()?;
            }
            let observations = self.observations;
            self.tell(&format!(
                "{observations} observations in {acknowledged} packets acknowledged, {came} of them there; slowest {:.1} times real time",
                self.slowest
            ))?;
            if came < acknowledged {
                bail!("{} packets that were acknowledged are not there", acknowledged - came);
            }
        }
        if let Some(figures) = of(&self.viewer.seen().score, 0).0 {
            self.tell(&format!("the whole shift: {figures}"))?;
        }
        self.host.stop();
        Ok(())
    }
}

fn of(score: &Score, from: usize) -> (Option<String>, usize) {
    (score.figures(from).map(|figures| figures.to_string()), score.len())
}

fn tell_at(time_s: f64, text: &str) -> Result<()> {
    let minutes = (time_s / 60.0).floor();
    print(&format!("{minutes:>3.0}:{:02.0}  {text}\n", (time_s - 60.0 * minutes).floor()))
}
