//! The feed: what is told to whom, and who is sent away.

use crate::house::{House, Tested, watch};
use adit_server::api::ApiSettings;
use adit_server::feed::{Feed, FeedSettings, Gone, Newest, News};
use adit_tracking::Event;
use std::time::Duration;

fn appeared(number: u64) -> Event {
    Event::TagAppeared { tag: format!("t{number}"), time: adit_server::now() }
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
