//! Packing changes nothing that is read, and takes little room and time.

use crate::common::{Site, at, fix, raw, round, track, whole_track};
use crate::walk::shift;
use adit_core::solution::Quality;
use adit_core::time::Time;
use adit_server::store::{FixRecord, Record, Round, Store, TrackOf, TrackQuery};
use std::time::Instant;

async fn write(store: &Store, fixes: &[FixRecord]) {
    let first = store.applied().await.unwrap() + 1;
    let rounds: Vec<Round> =
        (first..).zip(fixes).map(|(position, fix)| round(position, vec![Record::Fix(fix.clone())])).collect();
    for some in rounds.chunks(5000) {
        assert_eq!(store.commit_rounds(some).await.unwrap().refused, 0);
    }
}

/// What the store makes of a fix: ms, cm, radius up to 3.2 % larger.
fn assert_rounded(found: &FixRecord, given: &FixRecord) {
    assert!((found.time.nanos() - given.time.nanos()).abs() <= 500_000);
    for (found, given) in found.position_m.iter().zip(given.position_m) {
        assert!((found - given).abs() <= 0.005 + 1e-9, "{found} for {given}");
    }
    let (radius, given_radius) = (found.radius_95_m, given.radius_95_m);
    assert!(
        radius >= given_radius - 1e-6 && radius <= (given_radius + 0.01) * (1.0 + 1.0 / 32.0),
        "{radius} for {given_radius}"
    );
    assert_eq!(
        (&found.tag, &found.person, &found.level, &found.zone),
        (&given.tag, &given.person, &given.level, &given.zone)
    );
    assert_eq!(found.quality, given.quality);
}

#[tokio::test]
async fn what_is_read_is_the_same_before_and_after_packing() {
    let site = Site::new().await;
    let given = shift("t1", 9000, 1);
    write(&site.store, &given).await;
    let before = whole_track(&site.store, "t1").await;
    assert_eq!(before.len(), given.len());
    for (found, given) in before.iter().zip(&given) {
        assert_rounded(found, given);
    }
    let done = site.store.compact(at(10_000)).await.unwrap();
    assert_eq!(done.fixes, 9000);
    assert_eq!(whole_track(&site.store, "t1").await, before);
    // A span that begins and ends within chunks.
    let (from, until) = (before[1500].time, before[7001].time);
    assert_eq!(track(&site.store, TrackOf::Tag("t1".to_owned()), from, until).await, before[1500..7001]);
    assert_eq!(track(&site.store, TrackOf::Person("p-t1".to_owned()), from, until).await, before[1500..7001]);
}

#[tokio::test]
async fn small_chunks_become_whole_ones() {
    let site = Site::new().await;
    let given = shift("t1", 3600, 2);
    for (minute, fixes) in (0_i64..).zip(given.chunks(60)) {
        write(&site.store, fixes).await;
        site.store.compact(at(minute * 60 + 100)).await.unwrap();
    }
    let mut file = raw(&site).await;
    let counts: Vec<i64> = sqlx::query_scalar("SELECT count FROM track_chunk ORDER BY from_ms")
        .fetch_all(&mut file)
        .await
        .unwrap();
    assert_eq!(counts.iter().sum::<i64>(), 3600);
    assert!(counts[..3].iter().all(|count| (1024..=2048).contains(count)), "{counts:?}");
    assert!(counts.len() < 3 + 18, "{counts:?}");
    let found = whole_track(&site.store, "t1").await;
    assert_eq!(found.len(), 3600);
    assert!(
        found.iter().zip(&given).all(|(found, given)| found.tag == given.tag
            && (found.position_m[0] - given.position_m[0]).abs() < 0.006)
    );
}

#[tokio::test]
async fn a_late_fix_takes_its_place() {
    let site = Site::new().await;
    let all = shift("t1", 4000, 3);
    let late = |at: usize| at % 997 == 500;
    let in_time: Vec<_> =
        all.iter().enumerate().filter(|(at, _)| !late(*at)).map(|(_, fix)| fix.clone()).collect();
    write(&site.store, &in_time).await;
    site.store.compact(at(5000)).await.unwrap();
    let lateness: Vec<_> =
        all.iter().enumerate().filter(|(at, _)| late(*at)).map(|(_, fix)| fix.clone()).collect();
    assert_eq!(lateness.len(), 4);
    write(&site.store, &lateness).await;
    let mut expected = all;
    expected.sort_by_key(|fix| fix.time);
    let before = whole_track(&site.store, "t1").await;
    site.store.compact(at(6000)).await.unwrap();
    let after = whole_track(&site.store, "t1").await;
    assert_eq!(before, after);
    assert_eq!(after.len(), expected.len());
    let mut file = raw(&site).await;
    let spans: Vec<(i64, i64)> = sqlx::query_as("SELECT from_ms, until_ms FROM track_chunk ORDER BY from_ms")
        .fetch_all(&mut file)
        .await
        .unwrap();
    assert!(spans.windows(2).all(|pair| pair[0].1 <= pair[1].0), "chunks of a tag overlap: {spans:?}");
}

#[tokio::test]
async fn a_person_has_the_fixes_of_every_tag_carried_and_no_other() {
    let site = Site::new().await;
    let mut fixes = Vec::new();
    for second in 0..3000 {
        let mut one = fix("t1", second, second as f64);
        one.person = Some(if second < 1000 { "anna" } else { "bert" }.to_owned());
        fixes.push(one);
        let mut other = fix("t2", second, 50.0);
        other.person = (second >= 1000).then(|| "anna".to_owned());
        fixes.push(other);
    }
    write(&site.store, &fixes).await;
    for packed in [false, true] {
        if packed {
            site.store.compact(at(4000)).await.unwrap();
        }
        let anna = track(&site.store, TrackOf::Person("anna".to_owned()), at(0), at(3000)).await;
        assert_eq!(anna.len(), 3000);
        for (second, fix) in (0_i64..).zip(&anna) {
            assert_eq!(fix.tag, if second < 1000 { "t1" } else { "t2" });
            assert_eq!(fix.time, at(second));
        }
        let nobody = track(&site.store, TrackOf::Person("carla".to_owned()), at(0), at(3000)).await;
        assert_eq!(nobody, []);
    }
}

#[tokio::test]
async fn everybodys_last_fix_at_a_time() {
    let site = Site::new().await;
    let mut fixes = Vec::new();
    for second in 0..2000 {
        fixes.push(fix("t1", second, second as f64));
        if second < 100 {
            fixes.push(fix("t2", second, 7.0));
        }
    }
    write(&site.store, &fixes).await;
    for packed in [false, true] {
        if packed {
            site.store.compact(at(4000)).await.unwrap();
            // Newer ones beside the chunks.
            write(&site.store, &[fix("t1", 2000, 2000.0)]).await;
        }
        let there = site.store.last_fixes(at(1234)).await.unwrap();
        let told: Vec<_> = there.iter().map(|fix| (fix.tag.as_str(), fix.time)).collect();
        assert_eq!(told, [("t1", at(1234)), ("t2", at(99))]);
        assert_eq!(site.store.last_fixes(at(-1)).await.unwrap(), []);
    }
    assert_eq!(site.store.last_fixes(at(9999)).await.unwrap()[0].time, at(2000));
}

#[tokio::test]
async fn a_drawn_track_keeps_its_corners_and_says_how_far_it_is_off() {
    let site = Site::new().await;
    let corners = [[0.0, 0.0], [500.0, 0.0], [500.0, 300.0], [-200.0, 300.0]];
    let mut fixes = Vec::new();
    for (leg, ends) in (0_i64..).zip(corners.windows(2)) {
        for second in 0..1000 {
            let share = f64::from(second) / 1000.0;
            let mut one = fix("t1", leg * 1000 + i64::from(second), 0.0);
            // 10 cm to either side.
            let off = if second % 2 == 0 { 0.0 } else { 0.1 };
            one.position_m = [
                ends[0][0] + share * (ends[1][0] - ends[0][0]) + off,
                ends[0][1] + share * (ends[1][1] - ends[0][1]) + off,
                0.0,
            ];
            fixes.push(one);
        }
    }
    write(&site.store, &fixes).await;
    site.store.compact(at(4000)).await.unwrap();
    let query = TrackQuery { of: TrackOf::Tag("t1".to_owned()), from: at(0), until: at(5000) };
    let drawn = site.store.track_drawn(&query, 4).await.unwrap();
    assert_eq!((drawn.fixes.len(), drawn.of), (4, 3000));
    for (fix, corner) in drawn.fixes.iter().zip(corners).take(3) {
        // A corner is met to a step (0.7 m) and the noise.
        assert!(
            (fix.position_m[0] - corner[0]).hypot(fix.position_m[1] - corner[1]) < 1.0,
            "{fix:?} for {corner:?}"
        );
    }
    assert!(drawn.error_m > 0.05 && drawn.error_m < 1.0, "{}", drawn.error_m);
    let all = site.store.track_drawn(&query, 5000).await.unwrap();
    assert_eq!((all.fixes.len(), all.error_m), (3000, 0.0));
}

#[tokio::test]
async fn a_stored_fix_takes_at_most_five_bytes() {
    let site = Site::new().await;
    let (people, seconds) = (12, 8 * 3600);
    for person in 0..people {
        write(&site.store, &shift(&format!("tag-{person:04}"), seconds, person)).await;
        site.store.compact(at(40_000)).await.unwrap();
    }
    let mut file = raw(&site).await;
    let (fixes, packed, chunks): (i64, i64, i64) =
        sqlx::query_as("SELECT sum(count), sum(length(columns)), count(*) FROM track_chunk")
            .fetch_one(&mut file)
            .await
            .unwrap();
    assert_eq!(fixes, i64::from(u32::try_from(people * seconds as u64).unwrap()));
    let copy = site.folder.path().join("copy.db");
    site.store.backup(&copy).await.unwrap();
    let size = std::fs::metadata(&copy).unwrap().len();
    println!(
        "{fixes} fixes in {chunks} chunks: {:.2} bytes a fix in columns, {:.2} of the file with keys and pages",
        packed as f64 / fixes as f64,
        size as f64 / fixes as f64
    );
    // The whole file counts, not its columns alone.
    assert!(size as f64 / fixes as f64 <= 5.0);
}

#[tokio::test]
async fn a_day_opens_well_within_a_second() {
    let site = Site::new().await;
    let day = shift("t1", 86_400, 5);
    write(&site.store, &day).await;
    site.store.compact(at(90_000)).await.unwrap();
    let started = Instant::now();
    let fixes = track(&site.store, TrackOf::Tag("t1".to_owned()), at(-1), at(86_401)).await;
    let whole = started.elapsed();
    let started = Instant::now();
    let query = TrackQuery { of: TrackOf::Tag("t1".to_owned()), from: at(-1), until: at(86_401) };
    let drawn = site.store.track_drawn(&query, 2000).await.unwrap();
    println!(
        "a day: {} fixes read in {:.0} ms; drawn in {} points in {:.0} ms, off by {:.2} m at most",
        fixes.len(),
        whole.as_secs_f64() * 1e3,
        drawn.fixes.len(),
        started.elapsed().as_secs_f64() * 1e3,
        drawn.error_m
    );
    assert_eq!((fixes.len(), drawn.of, drawn.fixes.len()), (86_400, 86_400, 2000));
    assert!(whole.as_secs_f64() < 1.0);
}

#[tokio::test]
async fn ten_thousand_fixes_a_second_are_a_small_part_of_a_core() {
    let site = Site::new().await;
    let tags = 10_000_u32;
    let round_of = |second: u32| -> Vec<Record> {
        (0..tags)
            .map(|tag| {
                Record::Fix(FixRecord {
                    person: Some(format!("p{tag}")),
                    tag: format!("t{tag}"),
                    time: at(i64::from(second)),
                    position_m: [f64::from(tag), f64::from(second) * 1.3, -350.0],
                    radius_95_m: 0.5,
                    quality: Quality::Fixed,
                    level: Some("L1".to_owned()),
                    zone: None,
                })
            })
            .collect()
    };
    site.store.commit(1, round_of(0)).await.unwrap();
    let seconds = 60;
    let rounds: Vec<_> = (1..=seconds).map(round_of).collect();
    let started = Instant::now();
    let busy = cpu_seconds();
    for (position, records) in (2..).zip(rounds) {
        site.store.commit(position, records).await.unwrap();
    }
    let (writing, write_cpu) = (started.elapsed().as_secs_f64(), cpu_seconds() - busy);
    let (started, busy) = (Instant::now(), cpu_seconds());
    let done = site.store.compact(at(1000)).await.unwrap();
    let (packing, pack_cpu) = (started.elapsed().as_secs_f64(), cpu_seconds() - busy);
    let rows = f64::from(tags * seconds);
    println!(
        "{rows} fixes in commits of 10,000: {:.0} rows/s, {:.1} % of a core at 10,000/s; packed in {packing:.1} s into {} chunks, {:.1} % of a core",
        rows / writing,
        write_cpu / f64::from(seconds) * 100.0,
        done.chunks,
        pack_cpu / f64::from(seconds) * 100.0
    );
    let started = Instant::now();
    let there = site.store.last_fixes(Time::from_nanos(at(30).nanos())).await.unwrap();
    println!("everybody's last fix: {} in {:.0} ms", there.len(), started.elapsed().as_secs_f64() * 1e3);
    assert_eq!(there.len(), 10_000);
    // A tenth of a core is the aim; twice that is let pass since other tests run beside this one.
    assert!(write_cpu / f64::from(seconds) < 0.2);
}

/// Processor time of this process so far (Linux: user and system ticks of 10 ms).
fn cpu_seconds() -> f64 {
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let ticks: Vec<f64> = stat
        .rsplit(')')
        .next()
        .unwrap_or_default()
        .split_whitespace()
        .filter_map(|field| field.parse().ok())
        .collect();
    // Fields 14 and 15 of the whole line; after the name and the state come 11 numbers before them.
    ticks.get(10..12).map_or(0.0, |times| times.iter().sum::<f64>() / 100.0)
}
