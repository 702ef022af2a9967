//! The live WebSocket.

use crate::house::{House, Tested};
use futures_util::StreamExt as _;
use serde_json::{Value, json};
use tokio::net::TcpStream;
use tokio_tungstenite::tungstenite::Message;
use tokio_tungstenite::tungstenite::client::IntoClientRequest as _;
use tokio_tungstenite::{MaybeTlsStream, WebSocketStream, connect_async};

pub type Socket = WebSocketStream<MaybeTlsStream<TcpStream>>;

pub async fn watch(house: &House, path: &str, token: &str) -> Tested<Socket> {
    let mut request = format!("ws://{}{path}", house.address).into_client_request()?;
    request.headers_mut().insert("authorization", format!("Bearer {token}").parse()?);
    Ok(connect_async(request).await?.0)
}

pub async fn next(socket: &mut Socket) -> Tested<Value> {
    loop {
        let message = tokio::time::timeout(std::time::Duration::from_secs(20), socket.next()).await?;
        match message.ok_or("the socket ended")?? {
            Message::Text(text) => return Ok(serde_json::from_str(&text)?),
            Message::Close(frame) => return Err(format!("closed: {frame:?}").into()),
            _ => {}
        }
    }
}

#[tokio::test]
async fn a_snapshot_comes_first_then_events_in_order_and_the_last_position_of_each_tag() -> Tested {
    let house = House::new().await?;
    let mut socket = watch(&house, "/api/v1/live/socket", house.token("viewer")).await?;
    let snapshot = next(&mut socket).await?;
    assert_eq!((&snapshot["type"], &snapshot["event"]), (&"snapshot".into(), &0.into()), "{snapshot}");

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
    assert_eq!(next(&mut again).await?["type"], "resumed");
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
