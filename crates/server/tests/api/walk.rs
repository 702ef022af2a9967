//! Every route of the file of the API, without a token and with too small a role: what is added later is in it by itself.

use crate::house::{House, Tested};
use adit_server::api::open_routes;
use adit_server::auth::{Grant, Permission, Role};
use serde_json::Value;

struct Operation {
    id: String,
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
                id: text("operationId").ok_or_else(|| format!("{method} {path} has no operationId"))?,
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
async fn every_operation_has_a_name_of_its_own() -> Tested {
    let house = House::new().await?;
    let mut named = std::collections::BTreeMap::new();
    for Operation { id, method, path, .. } in operations(&house).await? {
        let word = id.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_');
        assert!(word, "{method} {path}: {id}");
        if let Some(other) = named.insert(id.clone(), format!("{method} {path}")) {
            return Err(format!("{id} is both {other} and {method} {path}").into());
        }
    }
    assert!(named.contains_key("get_tags_tag_following"), "{named:?}");
    Ok(())
}

#[tokio::test]
async fn every_route_without_a_token_answers_401_and_with_too_small_a_role_403() -> Tested {
    let house = House::new().await?;
    let operations = operations(&house).await?;
    assert!(operations.len() > 40, "only {} operations: is the file whole?", operations.len());
    let mut open = Vec::new();
    for Operation { method, path, permission, role, .. } in &operations {
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
    // What is open and not in the file of the API is a page of the console.
    let pages = open_routes().into_iter().filter(|route| !open.contains(route));
    for page in pages {
        let file = page.strip_prefix("GET /").ok_or_else(|| page.clone())?;
        assert!(!file.starts_with("api/") && !file.starts_with("v2/"), "{page} is open");
        let answer = house.ask("GET", &format!("/{file}"), "", None).await?;
        assert_eq!(answer.status, 200, "{page}");
        let policy = answer.headers.get("content-security-policy").ok_or("no policy")?.to_str()?;
        assert!(policy.starts_with("default-src 'self'; ") && policy.contains("frame-ancestors 'none'"));
        assert_eq!(answer.headers.get("x-content-type-options").ok_or("no sniffing")?, "nosniff");
    }
    Ok(())
}

#[tokio::test]
async fn a_role_that_suffices_is_let_in() -> Tested {
    let house = House::new().await?;
    for Operation { method, path, role, permission, .. } in operations(&house).await? {
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
    for path in [
        "/nothing",
        "/assets/nothing.js",
        "/api/v1/nothing",
        "/v2/nothing",
        "/api/v1/../../etc/passwd",
        "/api/v1/people/%00",
    ] {
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

#[test]
fn the_book_tells_the_table_of_who_may_do_what() -> Tested {
    use std::fmt::Write as _;
    let page = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/live/api.md");
    let page = std::fs::read_to_string(page)?;
    let (_, rest) = page.split_once("<!-- roles:begin -->\n").ok_or("no table")?;
    let (told, _) = rest.split_once("<!-- roles:end -->").ok_or("no end of the table")?;
    let mut table = "| permission | least role | to |\n|---|---|---|\n".to_owned();
    for permission in Permission::ALL {
        let (name, role) = (permission.name(), permission.least_role().name());
        writeln!(table, "| `{name}` | {role} | {} |", permission.description())?;
    }
    assert_eq!(told, table, "docs/live/api.md: put this table there");
    Ok(())
}
