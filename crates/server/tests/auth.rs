//! Users, sessions and tokens on a database of their own.

use adit_core::time::{Interval, Time};
use adit_server::auth::{
    Auth, AuthError, AuthSettings, Grant, LOCKED_AFTER, LOCKED_S, Permission, Role, UserChange,
};
use adit_server::store::Store;
use std::net::{IpAddr, Ipv4Addr};
use std::num::NonZeroU32;
use std::sync::Arc;
use std::sync::atomic::{AtomicI64, Ordering};
use std::time::Duration;

type Tested = Result<(), Box<dyn std::error::Error>>;

const HERE: IpAddr = IpAddr::V4(Ipv4Addr::LOCALHOST);
const PASSWORD: &str = "correct horse battery staple";

struct House {
    auth: Auth,
    store: Store,
    folder: tempfile::TempDir,
    now: Arc<AtomicI64>,
}

impl House {
    async fn new() -> Result<Self, Box<dyn std::error::Error>> {
        let often = NonZeroU32::new(1000).ok_or("no")?;
        let settings = AuthSettings {
            logins_per_address_per_minute: often,
            logins_per_name_per_minute: often,
            ..AuthSettings::default()
        };
        Self::with(settings).await
    }

    async fn with(settings: AuthSettings) -> Result<Self, Box<dyn std::error::Error>> {
        let folder = tempfile::tempdir()?;
        let store = Store::open(&folder.path().join("adit.db")).await?;
        let now = Arc::new(AtomicI64::new(1_800_000_000_000_000_000));
        let clock = Arc::clone(&now);
        let clock = Arc::new(move || Time::from_nanos(clock.load(Ordering::Relaxed)));
        Ok(Self { auth: Auth::open(store.clone(), settings, clock).await?, store, folder, now })
    }

    fn wait_s(&self, seconds: u32) {
        self.now.fetch_add(i64::from(seconds) * 1_000_000_000, Ordering::Relaxed);
    }

    async fn login(&self, name: &str) -> Result<String, AuthError> {
        Ok(self.auth.login(HERE, name, PASSWORD.into()).await?.secret.expose().into())
    }
}

#[tokio::test]
async fn the_first_start_makes_one_admin_whose_password_works() -> Tested {
    let house = House::new().await?;
    let password = house.auth.first_admin().await?.ok_or("no password")?;
    assert!(house.auth.first_admin().await?.is_none());
    let session = house.auth.login(HERE, "Admin", password).await?;
    assert_eq!((session.name.as_str(), session.role), ("admin", Role::Admin));
    let principal = house.auth.principal(session.secret.expose()).await?.ok_or("no session")?;
    assert!(principal.may(Permission::ManageUsers));
    Ok(())
}

#[tokio::test]
async fn the_database_holds_no_secret() -> Tested {
    let house = House::new().await?;
    house.auth.add_user("ann", Role::Viewer, PASSWORD.into()).await?;
    let session = house.login("ann").await?;
    let token = house.auth.add_token("ann", "gate", Grant::Ingest, None).await?;
    house.store.close().await;
    let file = std::fs::read(house.folder.path().join("adit.db"))?;
    let everything = String::from_utf8_lossy(&file);
    assert!(everything.contains("ann") && everything.contains("$argon2id$"));
    for secret in [PASSWORD, &session, token.secret.expose()] {
        assert!(!everything.contains(secret) && !everything.contains(&secret[7..]));
    }
    Ok(())
}

#[tokio::test]
async fn a_session_ends_when_idle_in_the_end_and_at_log_out() -> Tested {
    let house = House::new().await?;
    house.auth.add_user("ann", Role::Dispatcher, PASSWORD.into()).await?;
    let settings = house.auth.settings().clone();

    let idle = house.login("ann").await?;
    house.wait_s(settings.session_idle_s - 1);
    assert!(house.auth.principal(&idle).await?.is_some());
    house.wait_s(settings.session_idle_s);
    assert!(house.auth.principal(&idle).await?.is_none());

    let busy = house.login("ann").await?;
    let begun = Time::from_nanos(house.now.load(Ordering::Relaxed));
    let after = |seconds: u32| Some(begun + Interval::from_nanos(i64::from(seconds) * 1_000_000_000));
    let mut alive_s = 0;
    while house.auth.principal(&busy).await?.is_some() {
        // That it was seen is noted behind the request; when it would end tells that it was.
        let end = after((alive_s + settings.session_idle_s).min(settings.session_s));
        while house.auth.principal(&busy).await?.ok_or("it has ended")?.expires < end {
            tokio::time::sleep(Duration::from_millis(1)).await;
        }
        house.wait_s(3600);
        alive_s += 3600;
        assert!(alive_s <= settings.session_s, "a busy session lives on");
    }
    assert_eq!(alive_s, settings.session_s);

    let ended = house.login("ann").await?;
    let principal = house.auth.principal(&ended).await?.ok_or("no session")?;
    house.auth.logout(&principal).await?;
    assert!(house.auth.principal(&ended).await?.is_none());
    Ok(())
}

#[tokio::test]
async fn wrong_passwords_lock_a_name_for_a_while_but_not_the_sessions_it_has() -> Tested {
    let house = House::new().await?;
    house.auth.add_user("ann", Role::Dispatcher, PASSWORD.into()).await?;
    let open = house.login("ann").await?;
    for _ in 0..LOCKED_AFTER {
        let refused = house.auth.login(HERE, "ann", "wrong horse battery".into()).await;
        assert!(matches!(refused, Err(AuthError::WrongCredentials)));
    }
    assert!(matches!(house.login("ann").await, Err(AuthError::WrongCredentials)));
    assert!(house.auth.user("ann").await?.locked_until.is_some());
    assert!(house.auth.principal(&open).await?.is_some());
    house.wait_s(LOCKED_S);
    house.login("ann").await?;
    Ok(())
}

#[tokio::test]
async fn too_many_tries_are_turned_away_by_name_and_by_address() -> Tested {
    let (three, two) = (NonZeroU32::new(3).ok_or("no")?, NonZeroU32::new(2).ok_or("no")?);
    let settings = AuthSettings {
        logins_per_address_per_minute: three,
        logins_per_name_per_minute: two,
        ..AuthSettings::default()
    };
    let house = House::with(settings).await?;
    let mut limited = Vec::new();
    for name in ["nobody", "nobody", "nobody", "else"] {
        let refused = house.auth.login(HERE, name, PASSWORD.into()).await;
        limited.push(matches!(refused, Err(AuthError::TooManyTries { wait_s }) if wait_s > 0));
    }
    assert_eq!(limited, [false, false, true, true], "two for the name, three for the address");
    Ok(())
}

#[tokio::test]
async fn a_change_by_an_admin_counts_at_once_and_the_last_admin_stays() -> Tested {
    let house = House::new().await?;
    house.auth.add_user("boss", Role::Admin, PASSWORD.into()).await?;
    house.auth.add_user("ann", Role::Dispatcher, PASSWORD.into()).await?;
    let ann = house.login("ann").await?;
    let less = UserChange { role: Some(Role::Viewer), ..UserChange::default() };
    house.auth.change_user("ann", less.clone()).await?;
    assert!(house.auth.principal(&ann).await?.is_none(), "a session of the old role goes on");

    let off = UserChange { disabled: Some(true), ..UserChange::default() };
    house.auth.change_user("ann", off.clone()).await?;
    assert!(matches!(house.login("ann").await, Err(AuthError::WrongCredentials)));

    for refused in [
        house.auth.change_user("boss", less).await.err(),
        house.auth.change_user("boss", off).await.err(),
        house.auth.remove_user("boss").await.err(),
    ] {
        assert!(matches!(refused, Some(AuthError::LastAdmin { .. })), "{refused:?}");
    }
    assert_eq!(house.auth.user("boss").await?.role, Role::Admin);
    house.auth.add_user("chief", Role::Admin, PASSWORD.into()).await?;
    house.auth.remove_user("boss").await?;
    Ok(())
}

#[tokio::test]
async fn a_new_password_needs_the_old_one_and_ends_the_other_sessions() -> Tested {
    let house = House::new().await?;
    house.auth.add_user("ann", Role::Viewer, PASSWORD.into()).await?;
    let (here, there) = (house.login("ann").await?, house.login("ann").await?);
    let ann = house.auth.principal(&here).await?.ok_or("no session")?;
    let refused = house.auth.change_password(HERE, &ann, "wrong horse battery".into(), "x".repeat(20)).await;
    assert!(matches!(refused, Err(AuthError::WrongCredentials)));
    house.auth.change_password(HERE, &ann, PASSWORD.into(), "another good password".into()).await?;
    assert!(house.auth.principal(&here).await?.is_some());
    assert!(house.auth.principal(&there).await?.is_none());
    assert!(house.login("ann").await.is_err());
    Ok(())
}

#[tokio::test]
async fn tokens_end_when_they_say_and_when_revoked() -> Tested {
    let house = House::new().await?;
    let now = Time::from_nanos(house.now.load(Ordering::Relaxed));
    let in_an_hour = Time::from_nanos(now.nanos() + 3_600_000_000_000);
    let hour = house.auth.add_token("boss", "hour", Grant::Viewer, Some(in_an_hour)).await?;
    let gate = house.auth.add_token("boss", "gate", Grant::Ingest, None).await?;
    assert!(hour.secret.expose().starts_with(&hour.token.prefix));
    let again = house.auth.add_token("boss", "gate", Grant::Viewer, None).await;
    assert!(matches!(again, Err(AuthError::Taken { .. })));
    let late = house.auth.add_token("boss", "late", Grant::Viewer, Some(now)).await;
    assert!(matches!(late, Err(AuthError::Expired { .. })));

    let principal = house.auth.principal(gate.secret.expose()).await?.ok_or("no token")?;
    assert_eq!(principal.name, "token:gate");
    assert!(principal.may(Permission::Ingest) && !principal.may(Permission::SeeLive));
    house.wait_s(3600);
    assert!(house.auth.principal(hour.secret.expose()).await?.is_none());
    assert!(house.auth.principal(gate.secret.expose()).await?.is_some());
    house.auth.revoke_token(&gate.token.id).await?;
    assert!(house.auth.principal(gate.secret.expose()).await?.is_none());
    for not_one in ["", "adit_t_", "adit_s_x", &"x".repeat(100_000), "adit_t_' OR 1=1 --"] {
        assert!(house.auth.principal(not_one).await?.is_none());
    }
    Ok(())
}
