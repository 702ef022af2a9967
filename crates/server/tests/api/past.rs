//! What was, and what will be: replay, attendance as a file, anchors of the plan.

use crate::house::{House, Tested};
use adit_server::api::Timestamp;
use adit_server::{PlanChanges, now, with_changes};
use serde_json::json;

/// Somebody with a tag walks some metres down a roadway.
async fn walked(house: &House) -> Tested {
    let dispatcher = house.token("dispatcher");
    let person = json!({ "id": "p1", "name": "Ann, the first", "team": "north" });
    house.ask("POST", "/api/v1/people", dispatcher, Some(person)).await?;
    house.ask("POST", "/api/v1/tags", dispatcher, Some(json!({ "id": "t1" }))).await?;
    house.ask("POST", "/api/v1/tags/t1/assignments", dispatcher, Some(json!({ "person": "p1" }))).await?;
    let p = *house.context.mine.plan().roadways[0].points_m[0].raw();
    for step in 0..20 {
        house.walk("t1", [p.x, p.y + 0.5 * f64::from(step), p.z + 1.0]).await?;
        tokio::time::sleep(std::time::Duration::from_millis(20)).await;
    }
    Ok(())
}

#[tokio::test]
async fn a_replay_has_one_fix_for_each_tag_and_step() -> Tested {
    let house = House::new().await?;
    let from = Timestamp(now());
    walked(&house).await?;
    let until = Timestamp(now() + adit_core::time::Interval::from_nanos(1_000_000_000));
    let path = format!("/api/v1/history/positions?from={from}&until={until}&step_s=0.1");
    // The store is a moment behind.
    let whole = |answer: &serde_json::Value| {
        let north = answer["people"][0]["position_m"].as_array().and_then(|all| all.last()?[1].as_f64());
        let first = answer["people"][0]["position_m"][0][1].as_f64();
        north.zip(first).is_some_and(|(last, first)| last - first > 7.0)
    };
    let answer = house.until(&path, "dispatcher", whole).await?;
    let track = &answer.json["people"][0];
    assert_eq!((&track["person"], &track["tag"]), (&"p1".into(), &"t1".into()), "{}", answer.text);
    let times: Vec<f64> = serde_json::from_value(track["time_s"].clone())?;
    // Fixes are some 20 ms apart, or more where the disk is slow.
    assert!((3..20).contains(&times.len()), "{times:?}");
    // Times are whole ms.
    let steps: Vec<f64> = times.iter().map(|time| (time * 10.0 + 1e-3).floor()).collect();
    assert!(steps.windows(2).all(|pair| pair[0] < pair[1]), "{times:?}");
    for column in ["position_m", "radius_95_m", "quality", "level"] {
        assert_eq!(track[column].as_array().map(Vec::len), Some(times.len()), "{column}");
    }
    for (wrong, says) in [
        ("from=2026-01-01T00:00:00Z&until=2026-01-02T00:00:01Z", "at most 24 h"),
        ("from=2026-01-01T00:00:00Z&until=2026-01-01T01:00:00Z&step_s=0.01", "0.1 to 3600"),
        ("from=2026-01-02T00:00:00Z&until=2026-01-01T00:00:00Z", "expected a time after"),
    ] {
        let path = format!("/api/v1/history/positions?{wrong}");
        let answer = house.ask("GET", &path, house.token("dispatcher"), None).await?;
        assert!(answer.status == 422 && answer.text.contains(says), "{}", answer.text);
    }
    Ok(())
}

#[tokio::test]
async fn attendance_is_exported_with_names_and_stands_in_the_audit_log() -> Tested {
    let house = House::new().await?;
    walked(&house).await?;
    let path = "/api/v1/export/attendance?format=csv&from=2026-01-01T00:00:00Z&until=2100-01-01T00:00:00Z";
    let answer = house.ask("GET", path, house.token("safety-officer"), None).await?;
    assert_eq!(answer.headers["content-type"].to_str()?.split(';').next(), Some("text/csv"));
    let mut rows = csv::Reader::from_reader(answer.text.as_bytes());
    let row = rows.records().next().ok_or("no row")??;
    assert_eq!((&row[0], &row[1], &row[2], &row[5]), ("p1", "Ann, the first", "north", ""));
    let other = path.replace("csv", "xlsx");
    assert_eq!(house.ask("GET", &other, house.token("safety-officer"), None).await?.status, 422);
    let audit = house.ask("GET", "/api/v1/audit", house.token("safety-officer"), None).await?;
    assert_eq!(audit.json[0]["what"], "export.attendance");
    Ok(())
}

#[tokio::test]
async fn an_anchor_is_moved_at_the_next_start_and_an_unsound_plan_is_refused() -> Tested {
    let house = House::new().await?;
    let officer = house.token("safety-officer");
    let mine = &house.context.mine;
    let (first, second) = (mine.plan().anchors[0].clone(), mine.plan().anchors[1].clone());
    let p = *first.position_m.raw();
    let path = format!("/api/v1/mine/anchors/{}", first.id);
    let moved = json!({ "position_m": [p.x, p.y + 0.3, p.z], "name": "by the door" });
    let answer = house.ask("PUT", &path, officer, Some(moved)).await?;
    assert_eq!(
        (answer.status, &answer.json["in_force"]),
        (200, &"at the next start".into()),
        "{}",
        answer.text
    );
    let gone = format!("/api/v1/mine/anchors/{}", second.id);
    assert_eq!(house.ask("DELETE", &gone, officer, None).await?.status, 200);
    assert_eq!(house.ask("DELETE", &gone, officer, None).await?.status, 404, "it is gone already");
    let far = json!({ "position_m": [1e9, 0.0, 0.0] });
    let refused = house.ask("PUT", "/api/v1/mine/anchors/new", officer, Some(far)).await?;
    assert_eq!(refused.status, 422, "{}", refused.text);

    let list = house.ask("GET", "/api/v1/mine/anchors", house.token("viewer"), None).await?;
    let list = list.json.as_array().ok_or("no list")?.clone();
    let of = |id: &str| list.iter().find(|anchor| anchor["id"] == id).cloned().unwrap_or_default();
    assert_eq!(
        (&of(&first.id)["name"], &of(&first.id)["in_force"]),
        (&"by the door".into(), &"at the next start".into())
    );
    assert!(of(&second.id)["position_m"].is_null() && !of(&second.id)["position_now_m"].is_null());
    let audit = house.ask("GET", "/api/v1/audit", officer, None).await?;
    assert!(
        audit.json[0]["outcome"].as_str().is_some_and(|said| said.starts_with("refused")),
        "{}",
        audit.text
    );

    let changes = PlanChanges::read(house.folder())?;
    assert_eq!(changes, house.context.plan.changes().await, "as on the disk");
    let next = with_changes(adit_mine::Mine::clone(mine), house.folder())?;
    assert_eq!(next.plan().anchors.len(), mine.plan().anchors.len() - 1);
    let after = next.plan().anchors.iter().find(|anchor| anchor.id == first.id).ok_or("lost")?;
    assert!((after.position_m.raw() - p).norm() - 0.3 < 1e-9);
    assert_eq!(after.antenna_delay_ns, first.antenna_delay_ns, "what was calibrated stays");
    Ok(())
}
