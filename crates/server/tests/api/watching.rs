//! The live WebSocket.

use crate::house::{House, Tested, next, watch};
use adit_server::api::Timestamp;
use adit_server::now;
use serde_json::json;

#[tokio::test]
async fn a_snapshot_comes_first_then_events_in_order_and_the_last_position_of_each_tag() -> Tested {
    let house = House::new().await?;
    let mut socket = watch(&house, "/api/v1/live/socket", house.token("viewer")).await?;
    let snapshot = next(&mut socket).await?;
    assert_eq!((&snapshot["type"], &snapshot["event"]), (&"snapshot".into(), &0.into()), "{snapshot}");
    let time: Timestamp = snapshot["time"].as_str().ok_or("no time")?.parse()?;
    assert!((now() - time.0).seconds().abs() < 10.0, "{snapshot}");
    assert_eq!(snapshot["clock_speed"], 1.0);

    let dispatcher = house.token("dispatcher");
    for id in 0..5 {
        let person = json!({ "id": format!("p{id}"), "name": "x" });
        house.ask("POST", "/api/v1/people", dispatcher, Some(person)).await?;
        house.ask("POST", "/api/v1/tags", dispatcher, Some(json!({ "id": format!("t{id}") }))).await?;
        let path = format!("/api/v1/tags/t{id}/assignments");
        house.ask("POST", &path, dispatcher, Some(json!({ "person": format!("p{id}") }))).await?;
    }
    for number in 1..=5_u64 {
        let message = next(&mut socket).await?;
        assert_eq!((&message["type"], &message["number"]), (&"event".into(), &number.into()), "{message}");
        assert_eq!(message["body"]["event"], "tag-assigned");
    }
    drop(socket);

    let run = snapshot["run"].as_str().ok_or("no run")?;
    let path = format!("/api/v1/live/socket?run={run}&event=3&tick=0");
    let mut again = watch(&house, &path, house.token("viewer")).await?;
    let resumed = next(&mut again).await?;
    assert_eq!((&resumed["type"], &resumed["event"]), (&"resumed".into(), &3.into()), "{resumed}");
    assert_eq!(resumed["clock_speed"], 1.0);
    assert_eq!(next(&mut again).await?["number"], 4);
    assert_eq!(next(&mut again).await?["number"], 5);
    let mut other = watch(&house, "/api/v1/live/socket?run=x&event=3&tick=0", house.token("viewer")).await?;
    assert_eq!(next(&mut other).await?["type"], "snapshot", "of another run there is no going on");

    let p = *house.context.mine.plan().roadways[0].points_m[0].raw();
    for step in 1..=10 {
        house.walk("t1", [p.x + 0.1 * f64::from(step), p.y, p.z + 1.0]).await?;
    }
    let moved = loop {
        let message = next(&mut again).await?;
        if message["type"] == "positions" {
            break message;
        }
    };
    let positions = moved["positions"].as_array().ok_or("no positions")?;
    assert_eq!(positions.len(), 1, "one tag moved: {moved}");
    assert_eq!((&positions[0]["person"], &positions[0]["tag"]), (&"p1".into(), &"t1".into()));
    Ok(())
}

#[tokio::test]
async fn who_watches_is_told_when_the_clock_goes_at_another_speed() -> Tested {
    let house = House::new().await?;
    let mut socket = watch(&house, "/api/v1/live/socket", house.token("viewer")).await?;
    next(&mut socket).await?;
    let faster = json!({ "clock_speed": 8.0 });
    let refused = house.ask("PUT", "/api/v1/clock", house.token("admin"), Some(faster)).await?;
    assert_eq!(refused.status, 409, "the clock of a real mine cannot be set");
    house.context.clock.set_speed(8.0);
    let told = next(&mut socket).await?;
    assert_eq!((&told["type"], &told["clock_speed"]), (&"resumed".into(), &8.0.into()), "{told}");
    let before: Timestamp = told["time"].as_str().ok_or("no time")?.parse()?;
    tokio::time::sleep(std::time::Duration::from_millis(500)).await;
    let passed = (house.context.clock.now() - before.0).seconds();
    assert!(passed >= 4.0, "{passed} s at eight times the speed in half a second");
    Ok(())
}
