//! How commands and events look as JSON: the journal and the API keep to it.
#![expect(clippy::unwrap_used, reason = "tests")]

mod common;

use adit_tracking::{Command, Event, Rules, Severity};
use common::Room;
use serde_json::{Value, json};

#[test]
fn commands_are_named_and_leave_out_what_is_not_wanted() {
    let mut room = Room::default();
    let commands = [
        json!({"command": "create-person", "person": {"id": "17", "name": "Wang Li", "team": "drift 3", "allowed_zones": ["restricted"]}}),
        json!({"command": "create-tag", "tag": {"id": "a4", "kind": "person", "worn": "helmet"}}),
        json!({"command": "create-tag", "tag": {"id": "lhd-2", "kind": "vehicle"}}),
        json!({"command": "assign", "tag": "a4", "person": "17"}),
        json!({"command": "set-capacity", "zone": "shop", "capacity": 4}),
        json!({"command": "create-zone", "zone": {
            "zone": {"id": "blast", "kind": "restricted", "level": "upper", "outline_m": [[40.0, -5.0], [60.0, -5.0], [60.0, 5.0]]},
            "allowed_teams": ["blasters"],
        }}),
        json!({"command": "start-evacuation"}),
        json!({"command": "stop-evacuation", "note": "drill"}),
        json!({"command": "set-rules", "rules": {"contact": {"lost_after_s": 90.0}}}),
        json!({"command": "reset-zones"}),
    ];
    for command in commands {
        let read: Command = serde_json::from_value(command.clone()).unwrap();
        let again: Command = serde_json::from_value(serde_json::to_value(&read).unwrap()).unwrap();
        assert_eq!(again, read);
        room.command(read).unwrap();
    }
    assert_eq!(room.tracking.rules().contact.lost_after_s.to_string(), "90");
    assert_eq!(room.tracking.wearer("a4"), Some("17"));
}

#[test]
fn what_no_rule_knows_is_an_error() {
    let read = |rules: Value| serde_json::from_value::<Rules>(rules).map_err(|error| error.to_string());
    assert_eq!(read(json!({})), Ok(Rules::default()));
    let quiet = read(json!({"alarms": {"low_battery": {"severity": "medium"}}})).unwrap().alarms;
    assert_eq!((quiet.low_battery.severity, quiet.low_battery.enabled), (Severity::Medium, true));
    assert_eq!(quiet.overtime, Rules::default().alarms.overtime);
    assert!(read(json!({"alarms": {"low_battery": {"hold_off": 1.0}}})).unwrap_err().contains("hold_off_s"));
    assert!(read(json!({"contact": {"lost_after": 90.0}})).unwrap_err().contains("lost_after_s"));
    for (rules, why) in [
        (
            json!({"alarms": {"silence": {"hold_off_s": -1.0}}}),
            "rule alarms.silence.hold_off_s is expected from 0 to 10⁹, found -1",
        ),
        (
            json!({"escalation": {"high_after_s": [60.0, 60.0]}}),
            "rule escalation.high_after_s is expected above 0, rising, at most 10⁹, found 60",
        ),
        (
            json!({"battery": {"fine_share": 0.1}}),
            "rule battery.fine_share is expected from low_share to 1, found 0.1",
        ),
    ] {
        assert_eq!(read(rules).unwrap().check().unwrap_err().to_string(), why);
    }
    assert!(read(json!({"alarm": {}})).unwrap_err().contains("unknown field"));
}

#[test]
fn events_tell_what_they_are() {
    let mut room = Room::of(1, Rules::default());
    room.main(1.0, "t1", 201.0);
    let told: Vec<Value> = room.told().iter().map(|event| serde_json::to_value(event).unwrap()).collect();
    let names: Vec<&str> = told.iter().map(|event| event["event"].as_str().unwrap()).collect();
    assert_eq!(names, ["went-below", "level-changed", "zone-entered", "alarm-raised"]);
    let at_ns = common::at(1.0).nanos();
    let entered = json!({
        "event": "zone-entered", "zone": "dangerous", "subject": {"person": "p1"}, "kind": "person", "time": at_ns, "entry": "appeared",
    });
    assert_eq!(told[2], entered);
    let raised = json!({
        "event": "alarm-raised",
        "alarm": {
            "id": 1, "kind": "dangerous-zone", "about": {"person": "p1"}, "zone": "dangerous", "severity": "critical", "state": "raised",
            "escalation": 0, "raised_at": at_ns, "since": at_ns, "position_m": [201.0, 0.0, 1.0],
        },
    });
    assert_eq!(told[3], raised);
    for event in told {
        let read: Event = serde_json::from_value(event.clone()).unwrap();
        assert_eq!(serde_json::to_value(read).unwrap(), event);
    }
}
