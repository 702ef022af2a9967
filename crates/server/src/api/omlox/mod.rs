//! The omlox hub interface, version 2, as far as adit speaks it: compatible, not certified.
//!
//! | omlox | adit |
//! |---|---|
//! | zone | the mine, and what clients have put |
//! | location provider | a tag, and what clients have put |
//! | trackable | a person, and what clients have put |
//! | fence | a zone of adit, and what clients have put |
//! | `crs` `local` | the mine's grid, m |
//!
//! What clients put is kept as they gave it, unknown members too, and laid over what adit says of the same id. People and zones are
//! changed by `/api/v1`. docs/live/api.md tells what is and what is not compatible.

mod collections;
mod crs;
mod fence_event;
mod fence_watch;
mod fencing;
mod location;
mod objects;
mod places;
mod proximity;
mod shelf;
mod socket;

pub use fence_watch::FenceWatch;
pub(super) use fence_watch::watch;
pub use proximity::Proximities;

use super::routes::Routes;
use crate::auth::Permission;
use collections::{fences, providers, trackables, zones};
use utoipa_axum::routes;

/// All routes of `/v2`.
pub(super) fn mount(routes: Routes) -> Routes {
    macro_rules! collection {
        ($routes:expr, $($name:ident),*) => {
            $routes$(
                .needs(Permission::SeeLive, routes!($name::ids))
                .needs(Permission::ManageOmlox, routes!($name::add, $name::clear))
                .needs(Permission::SeeLive, routes!($name::summary))
                .needs(Permission::SeeLive, routes!($name::show))
                .needs(Permission::ManageOmlox, routes!($name::put, $name::remove))
            )*
        };
    }
    collection!(routes, zones, trackables, providers, fences)
        .needs(Permission::SeeLive, routes!(places::provider_location))
        .needs(Permission::Ingest, routes!(places::put_location))
        .needs(Permission::SeeLive, routes!(places::provider_locations))
        .needs(Permission::Ingest, routes!(places::put_locations))
        .needs(Permission::SeeLive, routes!(places::provider_fences))
        .needs(Permission::SeeLive, routes!(places::provider_trackables))
        .needs(Permission::SeeLive, routes!(places::trackable_location))
        .needs(Permission::SeeLive, routes!(places::trackable_locations))
        .needs(Permission::SeeLive, routes!(places::trackable_motion))
        .needs(Permission::SeeLive, routes!(places::trackable_motions))
        .needs(Permission::SeeLive, routes!(places::trackable_providers))
        .needs(Permission::SeeLive, routes!(places::trackable_fences))
        .needs(Permission::SeeLive, routes!(places::fence_locations))
        .needs(Permission::SeeLive, routes!(places::fence_providers))
        .needs(Permission::SeeLive, routes!(places::fence_trackables))
        .needs(Permission::SeeLive, routes!(places::fence_motions))
        .needs(Permission::Ingest, routes!(proximity::put_proximity))
        .needs(Permission::Ingest, routes!(proximity::put_proximities))
        .needs(Permission::SeeLive, routes!(proximity::provider_sensors))
        .needs(Permission::Ingest, routes!(proximity::put_sensors))
        .needs(Permission::SeeLive, routes!(proximity::trackable_sensors))
        .needs_inside(Permission::SeeLive, routes!(socket::watch))
}
