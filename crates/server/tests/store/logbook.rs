//! Events and alarms by time, kind and whom they are about, page by page.

use crate::common::{Site, alarm, at, event};
use adit_server::store::{LogQuery, Record};

#[tokio::test]
async fn pages_of_any_size_hold_every_event_once_in_either_order() {
    let site = Site::new().await;
    // Several at one time, and not in order.
    let events: Vec<_> = (0..97)
        .map(|number| {
            event(
                &format!("kind {}", number % 3),
                (number * 7 % 10) / 2,
                &["all", &format!("s{}", number % 5)],
            )
        })
        .collect();
    site.store.commit(1, events.iter().cloned().map(Record::Event).collect()).await.unwrap();
    let mut expected = events.clone();
    expected.sort_by_key(|event| event.time);
    for subject in [None, Some("all".to_owned())] {
        for newest_first in [false, true] {
            for limit in [1, 7, 96, 97, 98] {
                let mut query =
                    LogQuery { newest_first, limit, subject: subject.clone(), ..LogQuery::default() };
                let mut found = Vec::new();
                loop {
                    let page = site.store.events(&query).await.unwrap();
                    assert!(page.rows.len() <= limit as usize);
                    found.extend(page.rows);
                    let Some(next) = page.next else { break };
                    query.after = Some(next.to_string().parse().unwrap());
                }
                if newest_first {
                    found.reverse();
                }
                assert_eq!(found, expected, "{limit} at once");
            }
        }
    }
}

#[tokio::test]
async fn events_are_found_by_time_kind_and_subject() {
    let site = Site::new().await;
    let events = [
        event("in", 1, &["anna", "z1"]),
        event("out", 2, &["anna", "z1"]),
        event("in", 3, &["bert", "z1"]),
        event("fall", 4, &["bert"]),
    ];
    site.store.commit(1, events.iter().cloned().map(Record::Event).collect()).await.unwrap();
    let found = async |query: LogQuery| site.store.events(&query).await.unwrap().rows;
    let all = LogQuery::default;
    assert_eq!(found(LogQuery { from: Some(at(2)), until: Some(at(4)), ..all() }).await, events[1..3]);
    assert_eq!(
        found(LogQuery { kinds: vec!["out".to_owned(), "fall".to_owned()], ..all() }).await,
        [events[1].clone(), events[3].clone()]
    );
    assert_eq!(found(LogQuery { subject: Some("bert".to_owned()), ..all() }).await, events[2..]);
    assert_eq!(
        found(LogQuery {
            subject: Some("z1".to_owned()),
            kinds: vec!["in".to_owned()],
            from: Some(at(2)),
            ..all()
        })
        .await,
        events[2..3]
    );
    assert_eq!(found(LogQuery { subject: Some("' OR true --".to_owned()), ..all() }).await, []);
    assert!("1795327200".parse::<adit_server::store::Cursor>().is_err());
}

#[tokio::test]
async fn an_alarm_is_one_row_from_raised_to_cleared() {
    let site = Site::new().await;
    site.store
        .commit(
            1,
            vec![Record::Alarm(alarm("a", "raised", 1, None)), Record::Alarm(alarm("b", "raised", 2, None))],
        )
        .await
        .unwrap();
    let open = LogQuery { open: true, subject: Some("anna".to_owned()), ..LogQuery::default() };
    assert_eq!(site.store.alarms(&open).await.unwrap().rows.len(), 2);
    let mut cleared = alarm("a", "cleared", 1, Some(9));
    cleared.subjects = vec!["bert".to_owned()];
    site.store.commit(2, vec![Record::Alarm(cleared.clone())]).await.unwrap();
    assert_eq!(site.store.alarms(&open).await.unwrap().rows, [alarm("b", "raised", 2, None)]);
    assert_eq!(site.store.alarm("a").await.unwrap(), Some(cleared.clone()));
    assert_eq!(site.store.alarm("c").await.unwrap(), None);
    let by_state = LogQuery { states: vec!["cleared".to_owned()], ..LogQuery::default() };
    assert_eq!(site.store.alarms(&by_state).await.unwrap().rows, [cleared]);
    assert_eq!(site.store.alarms(&LogQuery::default()).await.unwrap().rows.len(), 2);
}
