//! Many viewers, and one that never reads.

use crate::house::{House, Tested};
use crate::watching::{next, watch};
use adit_server::api::ApiSettings;
use adit_server::feed::{Feed, FeedSettings, Gone, Newest, News};
use adit_tracking::evacuation::EvacuationSummary;
use adit_tracking::{Entry, Event, Subject, TagKind};
use futures_util::SinkExt as _;
use serde_json::json;
use std::sync::Arc;
use std::time::Duration;
use tokio_tungstenite::tungstenite::Message;

const VIEWERS: usize = 1000;
const EVENTS: u64 = 100;

fn appeared(number: u64) -> Event {
    Event::TagAppeared { tag: format!("t{number}"), time: adit_server::now() }
}

fn entered(number: u64) -> Event {
    Event::ZoneEntered {
        zone: format!("zone {number}"),
        subject: Subject::Tag("t".into()),
        kind: TagKind::Person,
        time: adit_server::now(),
        entry: Entry::Crossed,
    }
}

/// Long, so that the buffers on the way to who never reads are full soon.
fn long_event() -> Event {
    Event::EvacuationStopped {
        id: 1,
        by: "test".into(),
        note: "x".repeat(200_000),
        time: adit_server::now(),
        summary: EvacuationSummary::default(),
    }
}

/// Resident memory of this process, bytes.
fn resident() -> Tested<u64> {
    let status = std::fs::read_to_string("/proc/self/status")?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:")).ok_or("no VmRSS")?;
    Ok(1024 * line.trim().trim_end_matches(" kB").parse::<u64>()?)
}

/// Server and clients in one process: two descriptors for each viewer.
fn may_open() -> Tested<u64> {
    let limits = std::fs::read_to_string("/proc/self/limits")?;
    let line = limits.lines().find(|line| line.starts_with("Max open files")).ok_or("no limit")?;
    Ok(line.split_whitespace().nth(3).ok_or("no limit")?.parse()?)
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_thousand_watch_while_one_never_reads() -> Tested {
    if may_open()? < 2 * VIEWERS as u64 + 100 {
        eprintln!("SKIPPED (ulimit -n below {})", 2 * VIEWERS + 100);
        return Ok(());
    }
    let feed = FeedSettings { write_timeout_s: 2, events_kept: 4096, ..FeedSettings::default() };
    let house = House::with(ApiSettings::default(), feed).await?;
    // It opens the socket and reads nothing from then on: not even its kernel's buffer is emptied.
    let deaf = watch(&house, "/api/v1/live/socket", house.token("viewer")).await?;
    let mut sockets = Vec::new();
    for _ in 0..VIEWERS {
        let mut socket = watch(&house, "/v2/ws/socket", house.token("viewer")).await?;
        let subscribe = json!({ "event": "subscribe", "topic": "fence_events" });
        socket.send(Message::text(subscribe.to_string())).await?;
        assert_eq!(next(&mut socket).await?["event"], "subscribed");
        sockets.push(socket);
    }
    assert_eq!(house.context.feed.viewers(), VIEWERS + 1);

    let before = resident()?;
    let told = Arc::clone(&house.context.feed);
    let telling = tokio::spawn(async move {
        for number in 1..=EVENTS {
            told.tell([], &[long_event(), entered(number)]);
            tokio::time::sleep(Duration::from_millis(50)).await;
        }
    });
    let mut readers = tokio::task::JoinSet::new();
    for mut socket in sockets {
        readers.spawn(async move {
            for number in 1..=EVENTS {
                let message = next(&mut socket).await?;
                let found = &message["payload"][0]["foreign_id"];
                if *found != format!("zone {number}") {
                    return Err(format!("event {number} expected, found {found}").into());
                }
            }
            Tested::Ok(socket)
        });
    }
    let mut all = Vec::new();
    while let Some(reader) = readers.join_next().await {
        all.push(reader??);
    }
    telling.await?;
    assert_eq!(all.len(), VIEWERS, "everybody who reads is told everything, in order");
    for _ in 0..100 {
        if house.context.feed.viewers() == VIEWERS {
            break;
        }
        tokio::time::sleep(Duration::from_millis(100)).await;
    }
    assert_eq!(house.context.feed.viewers(), VIEWERS, "who never reads is sent away");
    let metrics = house.ask("GET", "/metrics", house.token("viewer"), None).await?.text;
    assert!(metrics.contains("adit_feed_closed_total{reason=\"not-reading\"} 1"), "{metrics}");
    // The events are 20 MB, kept once as they are and once as written; a copy for each viewer would be 20 GB.
    let grown = resident()?.saturating_sub(before);
    eprintln!("memory grew by {} MB", grown / 1_000_000);
    assert!(grown < 100_000_000, "memory grew by {grown} bytes");
    drop(deaf);
    Ok(())
}

#[tokio::test]
async fn a_viewer_whose_events_are_gone_is_told_so_and_no_event_is_left_out_silently() -> Tested {
    let feed = Feed::new(FeedSettings { events_kept: 100, ..FeedSettings::default() });
    let mut viewer = feed.watch(Newest::default()).ok_or("full")?;
    for number in 1..=100 {
        feed.tell([], &[appeared(number)]);
    }
    let mut expected = 1;
    while expected <= 100 {
        let News::Events(events) = viewer.news().await? else { return Err("events come first".into()) };
        for told in events {
            assert_eq!(told.number, expected);
            expected += 1;
        }
    }
    for number in 101..=201 {
        feed.tell([], &[appeared(number)]);
    }
    assert_eq!(viewer.news().await.err(), Some(Gone::EventsMissed));
    Ok(())
}

#[tokio::test]
async fn who_misses_ticks_gets_the_last_position_of_all_who_moved() -> Tested {
    let house =
        House::with(ApiSettings::default(), FeedSettings { tick_ms: 20, ..FeedSettings::default() }).await?;
    let feed = &house.context.feed;
    let mut viewer = feed.watch(feed.newest()).ok_or("full")?;
    let p = *house.context.mine.plan().roadways[0].points_m[0].raw();
    for (step, tag) in [(1.0, "a"), (2.0, "b"), (3.0, "a"), (4.0, "a")] {
        let before = feed.newest().tick;
        house.walk(tag, [p.x + 0.1 * step, p.y, p.z + 1.0]).await?;
        while feed.newest().tick == before {
            tokio::time::sleep(Duration::from_millis(5)).await;
        }
    }
    loop {
        match viewer.news().await? {
            News::Events(_) => {}
            News::Tick(_) => return Err("three ticks were missed".into()),
            News::Since { moved, .. } => {
                let told: Vec<_> =
                    moved.iter().map(|moved| (&*moved.tag, moved.last_known.position_m.raw().x)).collect();
                assert_eq!(told, [("a", p.x + 0.4), ("b", p.x + 0.2)]);
                return Ok(());
            }
        }
    }
}

#[tokio::test]
async fn no_more_than_may_watch_and_places_are_given_back() -> Tested {
    let house =
        House::with(ApiSettings::default(), FeedSettings { viewers: 2, ..FeedSettings::default() }).await?;
    let one = watch(&house, "/api/v1/live/socket", house.token("viewer")).await?;
    let _two = watch(&house, "/api/v1/live/socket", house.token("viewer")).await?;
    assert!(watch(&house, "/api/v1/live/socket", house.token("viewer")).await.is_err());
    drop(one);
    for _ in 0..100 {
        if house.context.feed.viewers() == 1 {
            break;
        }
        tokio::time::sleep(Duration::from_millis(20)).await;
    }
    watch(&house, "/api/v1/live/socket", house.token("viewer")).await?;
    Ok(())
}
