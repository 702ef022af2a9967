//! Every route of the file of the API, without a token and with too small a role: what is added later is in it by itself.

use crate::house::{House, Tested};
use adit_server::auth::{Grant, Permission, Role};
use serde_json::Value;

struct Operation {
    method: String,
    path: String,
    permission: Option<String>,
    role: Option<String>,
}

async fn operations(house: &House) -> Tested<Vec<Operation>> {
    let file = house.ask("GET", "/api/v1/openapi.json", house.token("viewer"), None).await?;
    let mut operations = Vec::new();
    for (path, item) in file.json["paths"].as_object().ok_or("no paths")? {
        for (method, operation) in item.as_object().ok_or("no operations")? {
            if !["get", "put", "post", "delete", "patch"].contains(&method.as_str()) {
                continue;
            }
            let text = |name: &str| operation[name].as_str().map(str::to_owned);
            operations.push(Operation {
                method: method.to_uppercase(),
                // Braces become a value that fits texts, numbers and UUIDs badly enough to be no one's.
                path: path
                    .split('/')
                    .map(|part| if part.starts_with('{') { "1" } else { part })
                    .collect::<Vec<_>>()
                    .join("/"),
                permission: text("x-adit-permission"),
                role: text("x-adit-role"),
            });
        }
    }
    Ok(operations)
}

#[tokio::test]
async fn every_route_without_a_token_answers_401_and_with_too_small_a_role_403() -> Tested {
    let house = House::new().await?;
    let operations = operations(&house).await?;
    assert!(operations.len() > 40, "only {} operations: is the file whole?", operations.len());
    let mut open = Vec::new();
    for Operation { method, path, permission, role } in &operations {
        let at = format!("{method} {path}");
        let (Some(permission), Some(role)) = (permission, role) else {
            open.push(at);
            continue;
        };
        for token in ["", "adit_t_nobody", "adit_s_nobody"] {
            let answer = house.ask(method, path, token, None).await?;
            assert_eq!(
                (answer.status, &answer.json["code"]),
                (401, &Value::from(401)),
                "{at}: {}",
                answer.text
            );
        }
        let least = Role::named(role).ok_or("no such role")?;
        let permission =
            Permission::ALL.into_iter().find(|p| p.name() == permission).ok_or("no such permission")?;
        let smaller = Role::ALL.into_iter().filter(|role| *role < least).map(Grant::from);
        for grant in smaller.chain((permission != Permission::Ingest).then_some(Grant::Ingest)) {
            let answer = house.ask(method, path, house.token(grant.name()), None).await?;
            assert_eq!(
                (answer.status, &answer.json["type"]),
                (403, &"forbidden".into()),
                "{at} as {}",
                grant.name()
            );
        }
    }
    open.sort();
    assert_eq!(open, ["GET /health", "GET /health/live", "POST /api/v1/session"], "only these may be open");
    Ok(())
}

#[tokio::test]
async fn a_role_that_suffices_is_let_in() -> Tested {
    let house = House::new().await?;
    for Operation { method, path, role, permission } in operations(&house).await? {
        let (Some(role), Some(permission)) = (role, permission) else { continue };
        if method != "GET" {
            continue;
        }
        let answer = house.ask(&method, &path, house.token(&role), None).await?;
        assert!(![401, 403].contains(&answer.status), "{method} {path} ({permission}): {}", answer.text);
        assert!(answer.status < 500, "{method} {path}: {}", answer.text);
    }
    Ok(())
}

#[tokio::test]
async fn what_is_no_route_tells_strangers_nothing_and_others_in_json() -> Tested {
    let house = House::new().await?;
    for path in ["/", "/api/v1/nothing", "/v2/nothing", "/api/v1/../../etc/passwd", "/api/v1/people/%00"] {
        assert_eq!(house.ask("GET", path, "", None).await?.status, 401, "{path}");
        let answer = house.ask("GET", path, house.token("admin"), None).await?;
        assert_eq!(
            (answer.status, &answer.json["type"]),
            (404, &"not-found".into()),
            "{path}: {}",
            answer.text
        );
    }
    let answer = house.ask("PATCH", "/api/v1/live", house.token("admin"), None).await?;
    assert_eq!((answer.status, &answer.json["type"]), (405, &"method-not-allowed".into()));
    assert!(answer.headers.get("allow").is_some_and(|allow| allow.to_str().is_ok_and(|a| a.contains("GET"))));
    assert_eq!(house.ask("PATCH", "/api/v1/live", "", None).await?.status, 401);
    Ok(())
}
