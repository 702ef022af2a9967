//! People, tags, zones, alarms and evacuation through the API.

use crate::house::{House, Tested};
use serde_json::json;

#[tokio::test]
async fn a_person_gets_a_tag_and_is_seen_below() -> Tested {
    let house = House::new().await?;
    let dispatcher = house.token("dispatcher");
    let person = json!({ "id": "p1", "name": "Ann", "team": "north" });
    assert_eq!(house.ask("POST", "/api/v1/people", dispatcher, Some(person.clone())).await?.status, 201);
    assert_eq!(house.ask("POST", "/api/v1/people", dispatcher, Some(person)).await?.status, 409);
    assert_eq!(house.ask("POST", "/api/v1/tags", dispatcher, Some(json!({ "id": "t1" }))).await?.status, 201);
    let given =
        house.ask("POST", "/api/v1/tags/t1/assignments", dispatcher, Some(json!({ "person": "p1" }))).await?;
    assert_eq!((given.status, &given.json["person"]), (201, &"p1".into()), "{}", given.text);

    let roadway = &house.context.mine.plan().roadways[0];
    let p = roadway.points_m[0].raw();
    house.walk("t1", [p.x, p.y, p.z + 1.0]).await?;
    let seen =
        house.until("/api/v1/people/p1", "viewer", |json| json["live"]["last_known"].is_object()).await?;
    let known = &seen.json["live"]["last_known"];
    assert_eq!(
        (&known["tag"], &known["quality"], &known["radius_95_m"]),
        (&"t1".into(), &"fixed".into(), &2.0.into())
    );
    assert!(
        known["time"]
            .as_str()
            .is_some_and(|t| t.ends_with('Z') && t.len() == "2026-11-22T21:03:00.250Z".len())
    );

    assert_eq!(house.ask("DELETE", "/api/v1/tags/t1/assignments", dispatcher, None).await?.status, 200);
    let path = "/api/v1/history/events?about=p1";
    let of = |json: &serde_json::Value, name: &str| {
        json["rows"].as_array().is_some_and(|rows| rows.iter().any(|row| row["event"] == name))
    };
    let history = house.until(path, "dispatcher", |json| of(json, "tag-returned")).await?;
    assert!(of(&history.json, "tag-assigned"), "{}", history.text);
    let audit = house.ask("GET", "/api/v1/audit?what=assign", house.token("admin"), None).await?;
    assert_eq!(audit.json[0]["who"], "token:dispatcher", "{}", audit.text);
    assert_eq!(audit.json[0]["detail"]["person"], "p1");

    let span = "from=2020-01-01T00:00:00Z&until=2100-01-01T00:00:00Z";
    for (format, begins) in [("csv", "time_s,"), ("geojson", "{"), ("parquet", "PAR1")] {
        for what in ["tracks", "events", "alarms"] {
            let path = format!("/api/v1/export/{what}?format={format}&{span}");
            let file = house.ask("GET", &path, house.token("safety-officer"), None).await?;
            assert_eq!(file.status, 200, "{path}: {}", file.text);
            assert!(file.text.starts_with(begins), "{path}: {:.80}", file.text);
        }
    }
    Ok(())
}

#[tokio::test]
async fn a_zone_is_drawn_and_an_evacuation_runs_and_ends() -> Tested {
    let house = House::new().await?;
    let officer = house.token("safety-officer");
    let level = house.context.mine.plan().levels[0].id.clone();
    let zone = json!({ "id": "z9", "kind": "key", "level": level, "outline_m": [[0, 0], [10, 0], [10, 10]] });
    let drawn = house.ask("POST", "/api/v1/zones", officer, Some(zone.clone())).await?;
    assert_eq!(drawn.status, 201, "{}", drawn.text);
    let flat =
        json!({ "id": "z8", "kind": "key", "level": level, "outline_m": [[0, 0], [10, 0], [1e9, 10]] });
    assert_eq!(house.ask("POST", "/api/v1/zones", officer, Some(flat)).await?.status, 422);
    let mut other = zone;
    other["id"] = "z7".into();
    assert_eq!(house.ask("PUT", "/api/v1/zones/z9", officer, Some(other)).await?.status, 422);
    assert_eq!(house.ask("DELETE", "/api/v1/zones/z9", officer, None).await?.status, 204);

    let dispatcher = house.token("dispatcher");
    let started =
        house.ask("POST", "/api/v1/evacuation", dispatcher, Some(json!({ "note": "smoke" }))).await?;
    assert_eq!(
        (started.status, &started.json["evacuation"]["note"]),
        (201, &"smoke".into()),
        "{}",
        started.text
    );
    assert_eq!(house.ask("POST", "/api/v1/evacuation", dispatcher, Some(json!({}))).await?.status, 409);
    assert_eq!(house.ask("POST", "/api/v1/evacuation/stop", dispatcher, Some(json!({}))).await?.status, 403);
    let ended =
        house.ask("POST", "/api/v1/evacuation/stop", officer, Some(json!({ "note": "air clear" }))).await?;
    assert_eq!((ended.status, &ended.json["evacuation"]), (200, &serde_json::Value::Null));
    assert_eq!(
        house.ask("POST", "/api/v1/alarms/77/acknowledge", dispatcher, Some(json!({}))).await?.status,
        404
    );
    Ok(())
}
