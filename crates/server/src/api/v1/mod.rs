//! adit's own API: everything that omlox has no word for, and the console's needs.

mod session;
mod tokens;
mod users;

use super::routes::Routes;
use crate::auth::Permission;
use utoipa_axum::routes;

/// All routes of `/api/v1`.
pub(super) fn mount(routes: Routes) -> Routes {
    routes
        .open(routes!(session::login))
        .needs(Permission::OwnAccount, routes!(session::me))
        .needs(Permission::OwnAccount, routes!(session::logout))
        .needs(Permission::OwnAccount, routes!(session::change_password))
        .needs(Permission::ManageUsers, routes!(users::list, users::add))
        .needs(Permission::ManageUsers, routes!(users::show, users::change, users::remove))
        .needs(Permission::ManageTokens, routes!(tokens::list, tokens::add))
        .needs(Permission::ManageTokens, routes!(tokens::revoke))
}
