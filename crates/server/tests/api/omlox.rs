//! The omlox interface as a client meets it.

use crate::house::{House, Socket, Tested, next, watch};
use futures_util::SinkExt as _;
use serde_json::{Value, json};
use tokio_tungstenite::connect_async;
use tokio_tungstenite::tungstenite::Message;

fn here(house: &House) -> [f64; 3] {
    let p = house.context.mine.plan().roadways[0].points_m[0].raw();
    [p.x, p.y, p.z + 1.0]
}

async fn say(socket: &mut Socket, message: Value) -> Tested<Value> {
    socket.send(Message::text(message.to_string())).await?;
    next(socket).await
}

#[tokio::test]
async fn a_location_that_is_put_comes_back_in_any_coordinates() -> Tested {
    let house = House::new().await?;
    let (gate, viewer) = (house.token("ingest"), house.token("viewer"));
    let [x, y, z] = here(&house);
    let body = json!({
        "position": { "type": "Point", "coordinates": [x, y, z] }, "source": "any", "provider_type": "uwb",
        "provider_id": "AA:BB:01", "accuracy": 0.5, "unknown": { "to": "adit" },
    });
    let put = house.ask("PUT", "/v2/providers/AA:BB:01/location", gate, Some(body.clone())).await?;
    assert_eq!(put.status, 204, "{}", put.text);
    let path = "/v2/providers/AA:BB:01/location";
    let local = house.until(path, "viewer", |json| json["position"].is_object()).await?.json;
    assert_eq!(
        (&local["crs"], &local["provider_id"], &local["accuracy"]),
        (&"local".into(), &"AA:BB:01".into(), &0.5.into())
    );
    assert_eq!(local["position"]["coordinates"], json!([x, y, z]));

    let earth = house.ask("GET", &format!("{path}?crs=EPSG:4326"), viewer, None).await?.json;
    let coordinates: Vec<f64> = serde_json::from_value(earth["position"]["coordinates"].clone())?;
    assert!(
        (-180.0..=180.0).contains(&coordinates[0]) && (-90.0..=90.0).contains(&coordinates[1]),
        "{earth}"
    );
    let again = json!({ "position": { "type": "Point", "coordinates": coordinates }, "crs": "EPSG:4326", "accuracy": 0.5 });
    assert_eq!(house.ask("PUT", "/v2/providers/other/location", gate, Some(again)).await?.status, 204);
    let other = house
        .until("/v2/providers/other/location", "viewer", |json| json["position"].is_object())
        .await?
        .json;
    let back: Vec<f64> = serde_json::from_value(other["position"]["coordinates"].clone())?;
    // Degrees with all their digits are good to 1e-8 m; what is left is the way to the Earth and back.
    for (there, back) in [x, y, z].into_iter().zip(back) {
        assert!((there - back).abs() < 1e-3, "{there} became {back}");
    }
    let geojson = house.ask("GET", "/v2/providers/locations?geojson=true", viewer, None).await?.json;
    assert_eq!(
        (&geojson["type"], geojson["features"].as_array().map(Vec::len)),
        (&"FeatureCollection".into(), Some(2))
    );
    assert_eq!(geojson["features"][0]["geometry"]["type"], "Point");

    for (bad, what) in [
        (json!({ "position": { "type": "Point", "coordinates": [x] } }), "one number"),
        (json!({ "position": { "type": "Polygon", "coordinates": [x, y, z] } }), "no point"),
        (
            json!({ "position": { "type": "Point", "coordinates": [x, y, z] }, "provider_id": "x" }),
            "another provider",
        ),
        (
            json!({ "position": { "type": "Point", "coordinates": [x, y, z] }, "crs": "EPSG:1" }),
            "no such system",
        ),
        (json!({ "position": { "type": "Point", "coordinates": [x, y] } }), "neither height nor floor"),
        (
            json!({ "position": { "type": "Point", "coordinates": [500.0, 95.0, 0.0] }, "crs": "EPSG:4326" }),
            "past the pole",
        ),
        (json!({ "position": { "type": "Point", "coordinates": [1e300, y, z] } }), "too far"),
    ] {
        let answer = house.ask("PUT", path, gate, Some(bad)).await?;
        assert_eq!((answer.status, &answer.json["code"]), (422, &422.into()), "{what}: {}", answer.text);
    }
    let on_floor = json!({ "position": { "type": "Point", "coordinates": [x, y] }, "floor": 0 });
    assert_eq!(house.ask("PUT", path, gate, Some(on_floor)).await?.status, 204);
    assert_eq!(house.ask("PUT", path, viewer, Some(body)).await?.status, 403);
    Ok(())
}

#[tokio::test]
async fn objects_are_kept_as_given_and_people_and_zones_are_among_them() -> Tested {
    let house = House::new().await?;
    let officer = house.token("safety-officer");
    let own = json!({ "id": "11:22", "type": "uwb", "name": "forklift", "properties": { "colour": "red" }, "vendor_extension": [1, 2] });
    let added = house.ask("POST", "/v2/providers", officer, Some(own.clone())).await?;
    assert_eq!((added.status, &added.json), (201, &own), "{}", added.text);
    assert_eq!(
        house.ask("GET", "/v2/providers/1122", officer, None).await?.json,
        own,
        "a MAC without its colons"
    );
    let changed = json!({ "type": "uwb", "name": "loader", "properties": { "colour": "blue" } });
    assert_eq!(house.ask("PUT", "/v2/providers/11:22", officer, Some(changed)).await?.status, 204);
    let trackable = json!({ "type": "virtual", "name": "visitor", "location_providers": ["11:22"] });
    let trackable = house.ask("POST", "/v2/trackables", officer, Some(trackable)).await?;
    let id = trackable.json["id"].as_str().ok_or("no id")?.to_owned();
    let providers = house.ask("GET", &format!("/v2/trackables/{id}/providers"), officer, None).await?;
    assert_eq!(providers.json[0]["name"], "loader", "{}", providers.text);

    house.ask("POST", "/api/v1/people", officer, Some(json!({ "id": "p1", "name": "Ann" }))).await?;
    let people = house.ask("GET", "/v2/trackables/summary", officer, None).await?;
    let names: Vec<_> = people.json.as_array().ok_or("no list")?.iter().map(|t| t["name"].clone()).collect();
    assert!(names.contains(&"Ann".into()) && names.contains(&"visitor".into()), "{names:?}");
    let fences = house.ask("GET", "/v2/fences/summary", officer, None).await?;
    assert_eq!(fences.json.as_array().map(Vec::len), Some(house.context.mine.plan().zones.len()));
    assert_eq!(fences.json[0]["region"]["type"], "Polygon");
    let zones = house.ask("GET", "/v2/zones/summary", officer, None).await?;
    assert_eq!(zones.json[0]["foreign_id"], house.context.mine.plan().name.as_str());

    let ann =
        people.json.as_array().and_then(|all| all.iter().find(|t| t["name"] == "Ann")).ok_or("no Ann")?;
    let path = format!("/v2/trackables/{}", ann["id"].as_str().ok_or("no id")?);
    assert_eq!(
        house.ask("DELETE", &path, officer, None).await?.status,
        409,
        "a person is removed by /api/v1"
    );
    assert_eq!(house.ask("DELETE", "/v2/trackables", officer, None).await?.status, 204);
    assert_eq!(house.ask("GET", &path, officer, None).await?.status, 200, "people stay");
    assert_eq!(house.ask("GET", &format!("/v2/trackables/{id}"), officer, None).await?.status, 404);
    for bad in [
        json!([]),
        json!({ "name": "no type" }),
        json!({ "type": "uwb", "id": 7 }),
        json!({ "type": "uwb", "properties": 7 }),
    ] {
        assert_eq!(house.ask("POST", "/v2/zones", officer, Some(bad)).await?.status, 422);
    }
    Ok(())
}

#[tokio::test]
async fn a_socket_tells_locations_motions_and_fences_to_those_who_may_know() -> Tested {
    let house = House::new().await?;
    let url = format!("ws://{}/v2/ws/socket", house.address);
    let (mut socket, _) = connect_async(&url).await?;
    let subscribe =
        |topic: &str, params: Value| json!({ "event": "subscribe", "topic": topic, "params": params });
    let refused = say(&mut socket, subscribe("location_updates", json!({}))).await?;
    assert_eq!((&refused["event"], &refused["code"]), (&"error".into(), &10_006.into()));
    let refused =
        say(&mut socket, subscribe("location_updates", json!({ "token": "adit_t_nobody" }))).await?;
    assert_eq!(refused["code"], 10_006);
    let refused =
        say(&mut socket, subscribe("location_updates", json!({ "token": house.token("ingest") }))).await?;
    assert_eq!(refused["code"], 10_004);
    let token = house.token("viewer");
    let first =
        say(&mut socket, subscribe("location_updates", json!({ "token": token, "crs": "EPSG:4326" })))
            .await?;
    assert_eq!((&first["event"], &first["subscription_id"]), (&"subscribed".into(), &1.into()), "{first}");
    for (message, code) in [
        (json!({ "event": "shout" }), 10_000),
        (subscribe("weather", json!({})), 10_001),
        (subscribe("location_updates", json!({ "crs": "EPSG:1" })), 10_002),
        (json!({ "event": "unsubscribe", "subscription_id": 99 }), 10_003),
        (json!({ "event": "message", "topic": "location_updates", "payload": [] }), 10_004),
        (json!(7), 10_005),
    ] {
        assert_eq!(say(&mut socket, message.clone()).await?["code"], code, "{message}");
    }
    let fences = say(&mut socket, subscribe("fence_events", json!({}))).await?;
    assert_eq!(fences["subscription_id"], 2);

    // Round the first tag's place, so that it enters.
    let [x, y, z] = here(&house);
    let level = house.context.mine.level_at(z).ok_or("no level")?.id.clone();
    let corners = [[x - 9.0, y - 9.0], [x + 9.0, y - 9.0], [x + 9.0, y + 9.0], [x - 9.0, y + 9.0]];
    let zone = json!({ "id": "here", "kind": "key", "level": level, "outline_m": corners });
    let drawn = house.ask("POST", "/api/v1/zones", house.token("safety-officer"), Some(zone)).await?;
    assert_eq!(drawn.status, 201, "{}", drawn.text);
    let mut gate = watch(&house, "/v2/ws/socket", house.token("ingest")).await?;
    let location = json!({ "position": { "type": "Point", "coordinates": [x, y, z] }, "provider_id": "t1", "accuracy": 0.5 });
    let publish = json!({ "event": "message", "topic": "location_updates", "payload": [location] });
    gate.send(Message::text(publish.to_string())).await?;

    let (mut entered, mut seen) = (None, None);
    while entered.is_none() || seen.is_none() {
        let message = next(&mut socket).await?;
        assert!(message.get("subscription_id").is_none(), "{message}");
        let object = message["payload"][0].clone();
        assert!(object.is_object(), "{message}");
        if message["topic"] == "fence_events" { entered = Some(object) } else { seen = Some(object) }
    }
    let (entered, seen) = (entered.ok_or("no")?, seen.ok_or("no")?);
    assert_eq!(
        (&entered["event_type"], &entered["provider_id"]),
        (&"region_entry".into(), &"t1".into()),
        "{entered}"
    );
    assert_eq!((&seen["provider_id"], &seen["crs"]), (&"t1".into(), &"EPSG:4326".into()), "{seen}");
    Ok(())
}

#[tokio::test]
async fn a_fence_that_a_client_puts_is_watched() -> Tested {
    let house = House::new().await?;
    let (officer, gate, viewer) =
        (house.token("safety-officer"), house.token("ingest"), house.token("viewer"));
    let [x, y, z] = here(&house);
    let ring =
        [[x - 9.0, y - 9.0], [x + 9.0, y - 9.0], [x + 9.0, y + 9.0], [x - 9.0, y + 9.0], [x - 9.0, y - 9.0]];
    let region = json!({ "type": "Polygon", "coordinates": [ring] });
    let fence =
        json!({ "id": "f1", "foreign_id": "dock", "crs": "local", "region": region, "exit_tolerance": 5.0 });
    assert_eq!(house.ask("POST", "/v2/fences", officer, Some(fence)).await?.status, 201);
    let bad = json!({ "id": "f2", "crs": "local", "region": { "type": "Point", "coordinates": [x, y] } });
    let refused = house.ask("POST", "/v2/fences", officer, Some(bad)).await?;
    assert_eq!((refused.status, refused.text.contains("radius")), (422, true), "{}", refused.text);

    let mut socket = watch(&house, "/v2/ws/socket", viewer).await?;
    let mut drawn = watch(&house, "/v2/ws/socket", viewer).await?;
    for (socket, topic) in [(&mut socket, "fence_events"), (&mut drawn, "fence_events:geojson")] {
        say(socket, json!({ "event": "subscribe", "topic": topic })).await?;
    }
    let put = async |dx: f64| -> Tested {
        let body = json!({ "position": { "type": "Point", "coordinates": [x + dx, y, z] }, "accuracy": 0.5 });
        assert_eq!(house.ask("PUT", "/v2/providers/t1/location", gate, Some(body)).await?.status, 204);
        house
            .until("/v2/providers/t1/location", "viewer", |json| {
                json["position"]["coordinates"][0] == json!(x + dx)
            })
            .await?;
        Ok(())
    };
    let of_fence = async |socket: &mut Socket| -> Tested<Value> {
        loop {
            let object = next(socket).await?["payload"][0].clone();
            let body = if object["type"] == "Feature" { &object["properties"] } else { &object };
            if body["fence_id"] == "f1" {
                return Ok(object);
            }
        }
    };
    put(0.0).await?;
    let entered = of_fence(&mut socket).await?;
    assert_eq!(
        (&entered["event_type"], &entered["provider_id"], &entered["foreign_id"]),
        (&"region_entry".into(), &"t1".into(), &"dock".into()),
        "{entered}"
    );
    assert_eq!(of_fence(&mut drawn).await?["geometry"], region);
    let inside = house.ask("GET", "/v2/fences/f1/locations", viewer, None).await?.json;
    assert_eq!(inside[0]["provider_id"], "t1", "{inside}");
    let fences = house.ask("GET", "/v2/providers/t1/fences", viewer, None).await?.json;
    assert!(fences.as_array().is_some_and(|all| all.iter().any(|one| one["id"] == "f1")), "{fences}");
    // Within the tolerance, then out of it.
    put(13.0).await?;
    put(15.0).await?;
    let left = of_fence(&mut socket).await?;
    assert_eq!(
        (&left["event_type"], &left["entry_time"]),
        (&"region_exit".into(), &entered["entry_time"]),
        "{left}"
    );
    assert!(left["exit_time"].as_str() > left["entry_time"].as_str(), "{left}");
    assert_eq!(house.ask("GET", "/v2/fences/f1/locations", viewer, None).await?.json, json!([]));
    assert_eq!(house.ask("DELETE", "/v2/fences/f1", officer, None).await?.status, 204);
    put(0.0).await?;
    assert_eq!(house.ask("GET", "/v2/fences/f1/locations", viewer, None).await?.status, 404);
    Ok(())
}

#[tokio::test]
async fn who_is_near_an_anchor_or_a_zone_is_there() -> Tested {
    let house = House::new().await?;
    let (officer, gate, viewer) =
        (house.token("safety-officer"), house.token("ingest"), house.token("viewer"));
    let mut socket = watch(&house, "/v2/ws/socket", viewer).await?;
    say(&mut socket, json!({ "event": "subscribe", "topic": "proximity_updates" })).await?;
    let anchor = &house.context.mine.plan().anchors[0];
    let near =
        json!({ "source": anchor.id, "provider_type": "rfid", "accuracy": 4.0, "properties": { "gate": 7 } });
    assert_eq!(house.ask("PUT", "/v2/providers/badge/proximity", gate, Some(near)).await?.status, 204);
    let told = next(&mut socket).await?["payload"][0].clone();
    assert_eq!(
        (&told["source"], &told["provider_id"], &told["properties"]["gate"], &told["provider_type"]),
        (&json!(anchor.id), &"badge".into(), &7.into(), &"rfid".into()),
        "{told}"
    );
    let there = house
        .until("/v2/providers/badge/location", "viewer", |json| json["position"].is_object())
        .await?
        .json;
    let at: [f64; 3] = (*anchor.position_m.raw()).into();
    assert_eq!((&there["position"]["coordinates"], &there["accuracy"]), (&json!(at), &4.0.into()));

    let [x, y, z] = here(&house);
    let (earth, floor) = {
        let body = json!({ "position": { "type": "Point", "coordinates": [x, y, z] } });
        assert_eq!(house.ask("PUT", "/v2/providers/other/location", gate, Some(body)).await?.status, 204);
        let path = "/v2/providers/other/location?crs=EPSG:4326";
        let place = house.until(path, "viewer", |json| json["position"].is_object()).await?.json;
        (place["position"].clone(), place["floor"].clone())
    };
    let zone = json!({ "id": "z1", "type": "rfid", "foreign_id": "reader 9", "position": earth, "radius": 6.0, "floor": floor });
    assert_eq!(house.ask("POST", "/v2/zones", officer, Some(zone)).await?.status, 201);
    let near = json!([{ "source": "reader 9", "provider_id": "card" }]);
    assert_eq!(house.ask("PUT", "/v2/providers/proximities", gate, Some(near)).await?.status, 204);
    let there =
        house.until("/v2/providers/card/location", "viewer", |json| json["position"].is_object()).await?.json;
    let east: Option<f64> = there["position"]["coordinates"][0].as_f64();
    assert!(east.is_some_and(|east| (east - x).abs() < 1e-3) && there["accuracy"] == 6.0, "{there}");

    for (bad, status) in [
        (json!({ "source": "nowhere", "accuracy": 1.0 }), 404),
        (json!({ "source": anchor.id }), 422),
        (json!({ "source": anchor.id, "accuracy": 1.0, "provider_id": "other" }), 422),
    ] {
        assert_eq!(house.ask("PUT", "/v2/providers/badge/proximity", gate, Some(bad)).await?.status, status);
    }

    let path = "/v2/providers/badge/sensors";
    assert_eq!(house.ask("GET", path, viewer, None).await?.json, json!({}));
    for said in [json!({ "gas": { "ch4": 0.2 } }), json!({ "temperature": 21.5 })] {
        assert_eq!(house.ask("PUT", path, gate, Some(said)).await?.status, 204);
    }
    let all = json!({ "gas": { "ch4": 0.2 }, "temperature": 21.5 });
    assert_eq!(house.ask("GET", path, viewer, None).await?.json, all);
    assert_eq!(house.ask("PUT", "/v2/providers/nobody/sensors", gate, Some(json!({}))).await?.status, 404);
    Ok(())
}
