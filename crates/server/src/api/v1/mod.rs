//! adit's own API: everything that omlox has no word for, and the console's needs.

mod alarms;
mod anchors;
mod audit;
mod backups;
mod clock;
mod exports;
mod following;
mod history;
mod live_socket;
pub(super) mod people;
mod replay;
mod rules;
mod session;
mod site;
pub(super) mod tags;
mod tokens;
mod users;
pub(super) mod zones;

use super::ApiError;
use super::routes::Routes;
use crate::auth::Permission;
use crate::ingest::LARGEST_BATCH;
use axum::extract::DefaultBodyLimit;
use utoipa_axum::router::UtoipaMethodRouter;
use utoipa_axum::routes;

/// All routes of `/api/v1`.
pub(super) fn mount(routes: Routes) -> Routes {
    let routes = account(routes);
    let routes = live(routes);
    routes
        .needs(Permission::SeeHistory, routes!(history::track_of_person))
        .needs(Permission::SeeHistory, routes!(history::track_of_tag))
        .needs(Permission::SeeHistory, routes!(replay::positions))
        .needs(Permission::SeeHistory, routes!(history::events))
        .needs(Permission::SeeHistory, routes!(history::alarms))
        .needs(Permission::SeeHistory, routes!(history::attendance))
        .needs(Permission::Export, routes!(exports::tracks))
        .needs(Permission::Export, routes!(exports::events))
        .needs(Permission::Export, routes!(exports::alarms))
        .needs(Permission::Export, routes!(exports::attendance))
        .needs(Permission::SeeAudit, routes!(history::audit))
        .needs(Permission::SeeAudit, routes!(audit::verification))
        .needs(Permission::SeeLive, routes!(rules::show))
        .needs(Permission::ManageRules, routes!(rules::put))
        .needs(Permission::BackUp, routes!(backups::list, backups::make))
        .needs(Permission::SeeSettings, routes!(site::settings))
        .needs(Permission::SeeLive, routes!(clock::now))
        .needs(Permission::SetClock, routes!(clock::set))
        .needs(Permission::Ingest, large(routes!(site::observations)))
}

/// A batch may be larger than other bodies.
fn large<S: Clone + Send + Sync + 'static>(
    (schemas, paths, handlers): UtoipaMethodRouter<S>,
) -> UtoipaMethodRouter<S> {
    (schemas, paths, handlers.layer(DefaultBodyLimit::max(LARGEST_BATCH)))
}

fn account(routes: Routes) -> Routes {
    routes
        .open(routes!(session::login))
        .needs(Permission::OwnAccount, routes!(session::me, session::logout))
        .needs(Permission::OwnAccount, routes!(session::change_password))
        .needs(Permission::ManageUsers, routes!(users::list, users::add))
        .needs(Permission::ManageUsers, routes!(users::show, users::change, users::remove))
        .needs(Permission::ManageTokens, routes!(tokens::list, tokens::add))
        .needs(Permission::ManageTokens, routes!(tokens::revoke))
}

fn live(routes: Routes) -> Routes {
    routes
        .needs(Permission::SeeLive, routes!(people::below))
        .needs(Permission::SeeLive, routes!(live_socket::watch))
        .needs(Permission::SeeLive, routes!(people::list))
        .needs(Permission::ManagePeople, routes!(people::add))
        .needs(Permission::SeeLive, routes!(people::show))
        .needs(Permission::ManagePeople, routes!(people::change, people::remove))
        .needs(Permission::ManagePeople, routes!(people::mark_out))
        .needs(Permission::SeeLive, routes!(tags::list))
        .needs(Permission::ManagePeople, routes!(tags::add))
        .needs(Permission::SeeLive, routes!(tags::show))
        .needs(Permission::SeeLive, routes!(following::of_tag))
        .needs(Permission::SeeLive, routes!(following::packets))
        .needs(Permission::ManagePeople, routes!(tags::change, tags::remove))
        .needs(Permission::ManagePeople, routes!(tags::assign, tags::unassign))
        .needs(Permission::SeeLive, routes!(zones::list))
        .needs(Permission::ManageZones, routes!(zones::add))
        .needs(Permission::SeeLive, routes!(zones::show))
        .needs(Permission::ManageZones, routes!(zones::change, zones::remove))
        .needs(Permission::ManageZones, routes!(zones::reset))
        .needs(Permission::SeeLive, routes!(zones::headcount))
        .needs(Permission::SeeLive, routes!(zones::devices))
        .needs(Permission::ManageZones, routes!(zones::forget_device))
        .needs(Permission::SeeLive, routes!(alarms::list))
        .needs(Permission::SeeLive, routes!(alarms::show))
        .needs(Permission::HandleAlarms, routes!(alarms::acknowledge))
        .needs(Permission::HandleAlarms, routes!(alarms::clear))
        .needs(Permission::HandleAlarms, routes!(alarms::comment))
        .needs(Permission::SeeLive, routes!(alarms::board))
        .needs(Permission::Evacuate, routes!(alarms::start))
        .needs(Permission::EndEvacuation, routes!(alarms::stop))
        .needs(Permission::SeeLive, routes!(site::plan))
        .needs(Permission::SeeLive, routes!(site::plan_geojson))
        .needs(Permission::SeeLive, routes!(anchors::list))
        .needs(Permission::ManageZones, routes!(anchors::put, anchors::remove))
}

/// What is changed has the id that the path says.
fn same_id(path: &str, body: &str) -> Result<(), ApiError> {
    if path == body {
        Ok(())
    } else {
        Err(ApiError::invalid(format!("id: expected '{path}' as in the path, found '{body}'")))
    }
}
