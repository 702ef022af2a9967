//! Rules, the check of the audit log, backups, and who asks behind a proxy.

use crate::house::{House, PASSWORD, Tested};
use adit_server::api::ApiSettings;
use adit_server::feed::FeedSettings;
use adit_server::store::Store;
use serde_json::json;

#[tokio::test]
async fn rules_are_put_checked_and_told() -> Tested {
    let house = House::new().await?;
    let officer = house.token("safety-officer");
    let before = house.ask("GET", "/api/v1/rules", house.token("viewer"), None).await?;
    assert_eq!(before.json["contact"]["lost_after_s"], json!(120.0), "{}", before.text);

    let wanted =
        json!({ "contact": { "lost_after_s": 45.0 }, "alarms": { "low_battery": { "enabled": false } } });
    let put = house.ask("PUT", "/api/v1/rules", officer, Some(wanted)).await?;
    assert_eq!(put.status, 200, "{}", put.text);
    let mut expected = before.json.clone();
    expected["contact"]["lost_after_s"] = json!(45.0);
    expected["alarms"]["low_battery"]["enabled"] = json!(false);
    assert_eq!(put.json, expected);
    assert_eq!(house.ask("GET", "/api/v1/rules", house.token("viewer"), None).await?.json, expected);
    assert!(
        (house.context.tracking.read().map_err(|_| "poisoned")?.rules().contact.lost_after_s - 45.0).abs()
            < 1e-9
    );

    for (bad, told) in [
        (json!({ "contact": { "lost_after_s": 0.0 } }), "contact.lost_after_s"),
        (json!({ "contact": { "lost_after": 45.0 } }), "lost_after"),
        (json!([]), ""),
    ] {
        let answer = house.ask("PUT", "/api/v1/rules", officer, Some(bad)).await?;
        assert_eq!(answer.status, 422, "{}", answer.text);
        assert!(answer.text.contains(told), "{}", answer.text);
    }
    assert_eq!(house.ask("GET", "/api/v1/rules", officer, None).await?.json, expected);
    let audit = house
        .until("/api/v1/audit?what=set-rules", "admin", |rows| rows.as_array().is_some_and(|r| r.len() == 2));
    let rows = audit.await?;
    assert_eq!(rows.json[1]["outcome"], json!("done"), "{}", rows.text);
    assert_eq!(rows.json[0]["outcome"].as_str().map(|how| how.starts_with("refused: rule")), Some(true));
    Ok(())
}

#[tokio::test]
async fn the_audit_log_is_checked_against_heads_kept_elsewhere() -> Tested {
    let house = House::new().await?;
    let officer = house.token("safety-officer");
    for tag in ["t1", "t2"] {
        let body = Some(json!({ "id": tag }));
        assert_eq!(house.ask("POST", "/api/v1/tags", house.token("admin"), body).await?.status, 201);
    }
    let checked =
        house.until("/api/v1/audit/verification", "safety-officer", |told| told["rows"] == json!(2)).await?;
    assert_eq!((&checked.json["sound"], &checked.json["broken"]), (&json!(true), &json!(null)));
    let head = checked.json["head"].as_str().ok_or("no head")?;
    let path = format!("/api/v1/audit/verification?heads={head}");
    assert_eq!(house.ask("GET", &path, officer, None).await?.json["sound"], json!(true));
    // The log of another world.
    let path = format!("/api/v1/audit/verification?heads=2:{}", "0".repeat(64));
    let other = house.ask("GET", &path, officer, None).await?;
    assert_eq!(other.json["sound"], json!(false), "{}", other.text);
    assert!(other.json["broken"].as_str().is_some_and(|told| told.contains("made anew")), "{}", other.text);
    assert_eq!(house.ask("GET", "/api/v1/audit/verification?heads=x", officer, None).await?.status, 422);
    Ok(())
}

#[tokio::test]
async fn a_backup_is_a_whole_store() -> Tested {
    let house = House::new().await?;
    let admin = house.token("admin");
    assert_eq!(house.ask("GET", "/api/v1/backups", admin, None).await?.json, json!([]));
    house.walk("t1", [5000.0, 3020.0, 113.0]).await?;
    house
        .until("/api/v1/history/events", "admin", |page| {
            page["rows"].as_array().is_some_and(|r| !r.is_empty())
        })
        .await?;
    let made = house.ask("POST", "/api/v1/backups", admin, None).await?;
    assert_eq!(made.status, 201, "{}", made.text);
    let listed = house.ask("GET", "/api/v1/backups", admin, None).await?;
    assert_eq!(listed.json, json!([made.json]), "{}", listed.text);
    let folder = house.context.store.path().parent().ok_or("no folder")?.join("backups");
    let copy = Store::open(&folder.join(made.json["name"].as_str().ok_or("no name")?)).await?;
    assert_eq!(copy.check().await?, Vec::<String>::new());
    assert!(copy.applied().await? > 0);
    let audit = house.ask("GET", "/api/v1/audit?what=backup", admin, None).await?;
    assert_eq!(audit.json[0]["detail"]["name"], made.json["name"], "{}", audit.text);
    Ok(())
}

#[tokio::test]
async fn nobody_says_for_themselves_from_where_they_ask() -> Tested {
    for (trusted, source) in [(vec![], "127.0.0.1"), (vec!["127.0.0.0/8".parse()?], "198.51.100.9")] {
        let settings = ApiSettings { trusted_proxies: trusted, ..ApiSettings::default() };
        let house = House::with(settings, FeedSettings::default()).await?;
        let login = json!({ "name": "boss", "password": PASSWORD });
        let request = reqwest::Client::new().post(house.url("/api/v1/session")).json(&login);
        // What the client has made up, then what the proxy saw.
        let request = request.header("x-forwarded-for", "10.1.2.3").header("x-forwarded-for", "198.51.100.9");
        assert_eq!(request.send().await?.status(), 200);
        let audit = house.ask("GET", "/api/v1/audit?what=session.login", house.token("admin"), None).await?;
        assert_eq!(audit.json[0]["source"], json!(source), "{}", audit.text);
    }
    Ok(())
}
