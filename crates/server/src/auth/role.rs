//! Roles, and the one table of what each may do.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// What a user is trusted with; each role may do all that those before it may.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Role {
    /// Sees what is now.
    Viewer,
    /// Runs the shift.
    Dispatcher,
    /// Answers for the rules: zones, the end of an evacuation, the record.
    SafetyOfficer,
    /// Answers for the server: users, tokens, settings.
    Admin,
}

impl Role {
    /// All roles, the least first.
    pub const ALL: [Self; 4] = [Self::Viewer, Self::Dispatcher, Self::SafetyOfficer, Self::Admin];

    /// As it is written in JSON and in the database.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Viewer => "viewer",
            Self::Dispatcher => "dispatcher",
            Self::SafetyOfficer => "safety-officer",
            Self::Admin => "admin",
        }
    }

    /// The role of that name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|role| role.name() == name)
    }
}

/// What a session or a token is good for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Grant {
    /// As [`Role::Viewer`].
    Viewer,
    /// As [`Role::Dispatcher`].
    Dispatcher,
    /// As [`Role::SafetyOfficer`].
    SafetyOfficer,
    /// As [`Role::Admin`].
    Admin,
    /// To send observations and positions, nothing else: for gateways. Tokens only.
    Ingest,
}

impl Grant {
    /// As it is written in JSON and in the database.
    pub const fn name(self) -> &'static str {
        match self.role() {
            Some(role) => role.name(),
            None => "ingest",
        }
    }

    /// The grant of that name.
    pub fn named(name: &str) -> Option<Self> {
        if name == "ingest" { Some(Self::Ingest) } else { Role::named(name).map(Self::from) }
    }

    /// The role that it is worth; `None` for gateways.
    pub const fn role(self) -> Option<Role> {
        match self {
            Self::Viewer => Some(Role::Viewer),
            Self::Dispatcher => Some(Role::Dispatcher),
            Self::SafetyOfficer => Some(Role::SafetyOfficer),
            Self::Admin => Some(Role::Admin),
            Self::Ingest => None,
        }
    }

    /// Does it allow this?
    pub fn allows(self, permission: Permission) -> bool {
        match self.role() {
            Some(role) => role >= permission.least_role(),
            None => permission == Permission::Ingest,
        }
    }
}

impl From<Role> for Grant {
    fn from(role: Role) -> Self {
        match role {
            Role::Viewer => Self::Viewer,
            Role::Dispatcher => Self::Dispatcher,
            Role::SafetyOfficer => Self::SafetyOfficer,
            Role::Admin => Self::Admin,
        }
    }
}

/// Something that one may be allowed to do. Every route names one; what no permission names cannot be mounted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Permission {
    /// One's own session and password.
    OwnAccount,
    /// What is now: people, tags, zones, alarms, headcounts, the mine, the health of gateways.
    SeeLive,
    /// What was: tracks, events, attendance.
    SeeHistory,
    /// People, tags, who wears which.
    ManagePeople,
    /// Acknowledge, comment and clear alarms.
    HandleAlarms,
    /// Start an evacuation.
    Evacuate,
    /// End an evacuation.
    EndEvacuation,
    /// Zones and their limits.
    ManageZones,
    /// The rules of alarms.
    ManageRules,
    /// Take the record out of the house.
    Export,
    /// Who did what.
    SeeAudit,
    /// Objects of the omlox interface.
    ManageOmlox,
    /// Users and their roles.
    ManageUsers,
    /// API tokens.
    ManageTokens,
    /// Copies of the store.
    BackUp,
    /// The settings in force.
    SeeSettings,
    /// How fast the clock of a simulated shift goes.
    SetClock,
    /// Send observations and positions.
    Ingest,
}

impl Permission {
    /// All of them, in the order of the documentation.
    pub const ALL: [Self; 18] = [
        Self::OwnAccount,
        Self::SeeLive,
        Self::SeeHistory,
        Self::ManagePeople,
        Self::HandleAlarms,
        Self::Evacuate,
        Self::EndEvacuation,
        Self::ManageZones,
        Self::ManageRules,
        Self::Export,
        Self::SeeAudit,
        Self::ManageOmlox,
        Self::ManageUsers,
        Self::ManageTokens,
        Self::BackUp,
        Self::SeeSettings,
        Self::SetClock,
        Self::Ingest,
    ];

    /// The table: the least role, the name in the API's file, what it is.
    const fn row(self) -> (Role, &'static str, &'static str) {
        match self {
            Self::OwnAccount => {
                (Role::Viewer, "own-account", "see and end one's own session, change one's own password")
            }
            Self::SeeLive => (
                Role::Viewer,
                "see-live",
                "see people, tags, zones, alarms, headcounts, the evacuation board, the mine, gateways",
            ),
            Self::SeeHistory => {
                (Role::Dispatcher, "see-history", "see tracks, events and attendance of the past")
            }
            Self::ManagePeople => (
                Role::Dispatcher,
                "manage-people",
                "add, change and remove people and tags, give tags out and take them back, mark people out",
            ),
            Self::HandleAlarms => {
                (Role::Dispatcher, "handle-alarms", "acknowledge, comment and clear alarms")
            }
            Self::Evacuate => (Role::Dispatcher, "evacuate", "start an evacuation"),
            Self::EndEvacuation => (Role::SafetyOfficer, "end-evacuation", "end an evacuation"),
            Self::ManageZones => (
                Role::SafetyOfficer,
                "manage-zones",
                "add, change and remove zones and the anchors of the plan, forget gateways and anchors",
            ),
            Self::ManageRules => (Role::SafetyOfficer, "manage-rules", "change the rules of alarms"),
            Self::Export => (Role::SafetyOfficer, "export", "export tracks, events and alarms"),
            Self::SeeAudit => (Role::SafetyOfficer, "see-audit", "read the audit log"),
            Self::ManageOmlox => {
                (Role::SafetyOfficer, "manage-omlox", "add, change and delete objects of /v2")
            }
            Self::ManageUsers => (Role::Admin, "manage-users", "add, change and delete users"),
            Self::ManageTokens => (Role::Admin, "manage-tokens", "make and revoke API tokens"),
            Self::BackUp => (Role::Admin, "back-up", "make and list copies of the store"),
            Self::SeeSettings => (Role::Admin, "see-settings", "see the settings in force"),
            Self::SetClock => (Role::Admin, "set-clock", "set the speed of a simulated shift"),
            Self::Ingest => (
                Role::Admin,
                "ingest",
                "send observations and positions (also tokens with the grant `ingest`)",
            ),
        }
    }

    /// The least role that may.
    pub const fn least_role(self) -> Role {
        self.row().0
    }

    /// As the file of the API names it.
    pub const fn name(self) -> &'static str {
        self.row().1
    }

    /// What it is, in words.
    pub const fn description(self) -> &'static str {
        self.row().2
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_role_may_all_that_a_lesser_one_may() {
        for permission in Permission::ALL {
            let may: Vec<bool> =
                Role::ALL.into_iter().map(|role| Grant::from(role).allows(permission)).collect();
            assert!(may.is_sorted(), "{}: {may:?}", permission.name());
            assert!(Grant::Admin.allows(permission));
        }
    }

    #[test]
    fn a_gateway_may_send_and_nothing_else() {
        let may: Vec<_> = Permission::ALL.into_iter().filter(|p| Grant::Ingest.allows(*p)).collect();
        assert_eq!(may, [Permission::Ingest]);
    }

    #[test]
    fn names_are_read_back() {
        for grant in [Grant::Viewer, Grant::Dispatcher, Grant::SafetyOfficer, Grant::Admin, Grant::Ingest] {
            assert_eq!(Grant::named(grant.name()), Some(grant));
            assert_eq!(serde_json::to_value(grant).ok(), Some(grant.name().into()));
        }
        assert_eq!(Grant::named("root"), None);
    }
}
