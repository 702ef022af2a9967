//! Logging in, cookies, users, tokens, the audit log.

use crate::house::{House, PASSWORD, Tested};
use serde_json::json;

#[tokio::test]
async fn a_user_logs_in_works_and_logs_out() -> Tested {
    let house = House::new().await?;
    let wrong = json!({ "name": "boss", "password": "not this one at all" });
    let answer = house.ask("POST", "/api/v1/session", "", Some(wrong)).await?;
    assert_eq!((answer.status, &answer.json["type"]), (401, &"wrong-credentials".into()));

    let right = json!({ "name": "boss", "password": PASSWORD });
    let answer = house.ask("POST", "/api/v1/session", "", Some(right)).await?;
    assert_eq!(answer.status, 200, "{}", answer.text);
    let cookie = answer.headers.get("set-cookie").ok_or("no cookie")?.to_str()?;
    for part in ["adit_session=adit_s_", "HttpOnly", "SameSite=Strict", "Path=/"] {
        assert!(cookie.contains(part), "{cookie}");
    }
    let token = answer.json["token"].as_str().ok_or("no token")?;
    let me = house.ask("GET", "/api/v1/session", token, None).await?;
    assert_eq!((&me.json["name"], &me.json["grant"]), (&"boss".into(), &"admin".into()));
    assert_eq!(house.ask("DELETE", "/api/v1/session", token, None).await?.status, 204);
    assert_eq!(house.ask("GET", "/api/v1/session", token, None).await?.status, 401);

    let audit = house.ask("GET", "/api/v1/audit", house.token("admin"), None).await?;
    let rows = audit.json.as_array().ok_or("no rows")?;
    let told: Vec<_> = rows.iter().rev().map(|row| (row["what"].as_str(), row["outcome"].as_str())).collect();
    let (login, logout) = (Some("session.login"), Some("session.logout"));
    assert_eq!(told, [(login, Some("refused")), (login, Some("done")), (logout, Some("done"))]);
    Ok(())
}

#[tokio::test]
async fn a_cookie_counts_for_our_own_pages_alone() -> Tested {
    let house = House::new().await?;
    let right = json!({ "name": "boss", "password": PASSWORD });
    let session = house.ask("POST", "/api/v1/session", "", Some(right.clone())).await?;
    let cookie = format!("adit_session={}", session.json["token"].as_str().ok_or("no token")?);
    let client = reqwest::Client::new();
    let logout = |headers: &[(&'static str, String)]| {
        let mut request = client.delete(house.url("/api/v1/users/nobody")).header("cookie", &cookie);
        for (name, value) in headers {
            request = request.header(*name, value);
        }
        request.send()
    };
    let host = house.address.to_string();
    let foreign = [
        vec![("origin", "http://evil.example".to_owned())],
        vec![("sec-fetch-site", "cross-site".to_owned())],
        vec![("sec-fetch-site", "same-site".to_owned()), ("origin", format!("http://{host}"))],
        vec![("origin", "null".to_owned())],
    ];
    for headers in foreign {
        assert_eq!(logout(&headers).await?.status(), 403, "{headers:?}");
    }
    for headers in
        [vec![("origin", format!("http://{host}"))], vec![("sec-fetch-site", "same-origin".to_owned())]]
    {
        assert_eq!(logout(&headers).await?.status(), 404, "{headers:?}");
    }
    let read = client.get(house.url("/api/v1/session")).header("cookie", &cookie).send().await?;
    assert_eq!(read.status(), 200);
    let foreign_login =
        client.post(house.url("/api/v1/session")).header("origin", "http://evil.example").json(&right);
    assert_eq!(foreign_login.send().await?.status(), 403);
    Ok(())
}

#[tokio::test]
async fn an_admin_adds_a_user_and_a_token_and_takes_them_away() -> Tested {
    let house = House::new().await?;
    let admin = house.token("admin");
    let ann = json!({ "name": "ann", "role": "dispatcher", "password": "a long enough one" });
    let added = house.ask("POST", "/api/v1/users", admin, Some(ann.clone())).await?;
    assert_eq!((added.status, &added.json["role"]), (201, &"dispatcher".into()), "{}", added.text);
    assert!(!added.text.contains("argon") && !added.text.contains("long enough"));
    assert_eq!(house.ask("POST", "/api/v1/users", admin, Some(ann)).await?.status, 409);
    let less = house.ask("PATCH", "/api/v1/users/ann", admin, Some(json!({ "role": "viewer" }))).await?;
    assert_eq!((less.status, &less.json["role"]), (200, &"viewer".into()));
    let last = house.ask("DELETE", "/api/v1/users/boss", admin, None).await?;
    assert_eq!((last.status, &last.json["type"]), (409, &"conflict".into()));
    assert_eq!(house.ask("DELETE", "/api/v1/users/ann", admin, None).await?.status, 204);
    assert_eq!(house.ask("GET", "/api/v1/users/ann", admin, None).await?.status, 404);

    let made = house
        .ask("POST", "/api/v1/tokens", admin, Some(json!({ "name": "wall", "grant": "viewer" })))
        .await?;
    assert_eq!(made.status, 201, "{}", made.text);
    let secret = made.json["secret"].as_str().ok_or("no secret")?;
    assert_eq!(house.ask("GET", "/api/v1/live", secret, None).await?.status, 200);
    assert!(!house.ask("GET", "/api/v1/tokens", admin, None).await?.text.contains(secret));
    let path = format!("/api/v1/tokens/{}", made.json["token"]["id"].as_str().ok_or("no id")?);
    assert_eq!(house.ask("DELETE", &path, admin, None).await?.status, 200);
    assert_eq!(house.ask("GET", "/api/v1/live", secret, None).await?.status, 401);
    Ok(())
}

#[tokio::test]
async fn what_cannot_be_read_is_answered_in_json() -> Tested {
    let house = House::new().await?;
    let admin = house.token("admin");
    let client = reqwest::Client::new();
    let post = |body: &'static str, kind: &'static str| {
        client
            .post(house.url("/api/v1/users"))
            .bearer_auth(admin)
            .header("content-type", kind)
            .body(body)
            .send()
    };
    let json = "application/json";
    let huge: &'static str = Box::leak(format!("\"{}\"", "x".repeat(300_000)).into_boxed_str());
    let bad = [
        ("{", json, 400),
        ("[]", json, 422),
        (r#"{"name":"a","role":"king","password":"long enough one"}"#, json, 422),
        (r#"{"name":"a","role":"viewer","password":"long enough one","more":1}"#, json, 422),
        (r#"{"name":"A B","role":"viewer","password":"long enough one"}"#, json, 422),
        (r#"{"name":"a","role":"viewer","password":"short"}"#, json, 422),
        ("name=a", "application/x-www-form-urlencoded", 415),
        (huge, json, 413),
    ];
    for (body, kind, status) in bad {
        let answer = post(body, kind).await?;
        assert_eq!(answer.status(), status, "{}", &body[..body.len().min(80)]);
        let problem: serde_json::Value = answer.json().await?;
        assert_eq!(problem["code"], status);
        assert!(problem["message"].as_str().is_some_and(|m| !m.is_empty()) && problem["type"].is_string());
    }
    for query in [
        "limit=0",
        "limit=x",
        "from=yesterday",
        "nothing=1",
        "from=2026-01-02T00:00:00Z&until=2026-01-01T00:00:00Z",
    ] {
        let answer = house.ask("GET", &format!("/api/v1/audit?{query}"), admin, None).await?;
        assert!([400, 422].contains(&answer.status), "{query}: {}", answer.text);
    }
    Ok(())
}
