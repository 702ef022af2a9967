//! Routes with what each needs. There is no way to mount one without saying so, and what is not in the table is denied.

use super::Context;
use crate::auth::Permission;
use crate::console::Page;
use axum::http::{HeaderMap, Method};
use std::collections::HashMap;
use std::sync::Arc;
use utoipa::openapi::path::Operation;
use utoipa::openapi::security::SecurityRequirement;
use utoipa::openapi::{ContentBuilder, OpenApi, Ref, RefOr, Response, ResponseBuilder};
use utoipa_axum::router::{OpenApiRouter, UtoipaMethodRouter};

/// What a route needs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Access {
    /// Nothing: health and log-in.
    Open,
    /// Nothing, and other sites may link to it: a page of the console.
    Page,
    /// That the caller is allowed this.
    Needs(Permission),
    /// The same, but a WebSocket may be opened first and say who it is in its messages.
    NeedsInside(Permission),
}

/// What each route needs, by method and path.
#[derive(Debug, Clone, Default)]
pub struct AccessTable {
    of_route: HashMap<(Method, String), Access>,
}

impl AccessTable {
    /// What the route needs; `None` for what is no route.
    pub fn of(&self, method: &Method, path: &str) -> Option<Access> {
        let method = if method == Method::HEAD { Method::GET } else { method.clone() };
        self.of_route.get(&(method, path.to_owned())).copied()
    }

    /// What anybody may ask.
    pub fn open(&self) -> Vec<String> {
        let open = self.of_route.iter().filter(|(_, access)| matches!(access, Access::Open | Access::Page));
        let mut open: Vec<_> = open.map(|((method, path), _)| format!("{method} {path}")).collect();
        open.sort();
        open
    }
}

/// Routes under construction.
pub struct Routes {
    router: OpenApiRouter<Arc<Context>>,
    table: AccessTable,
}

impl Routes {
    /// None yet; `openapi` is what the file of the API begins with.
    pub fn new(openapi: OpenApi) -> Self {
        Self { router: OpenApiRouter::with_openapi(openapi), table: AccessTable::default() }
    }

    /// Mounts what anybody may ask.
    pub fn open(self, routes: UtoipaMethodRouter<Arc<Context>>) -> Self {
        self.mount(Access::Open, routes)
    }

    /// Mounts what needs a permission.
    pub fn needs(self, permission: Permission, routes: UtoipaMethodRouter<Arc<Context>>) -> Self {
        self.mount(Access::Needs(permission), routes)
    }

    /// Mounts a WebSocket whose messages may carry the token.
    pub fn needs_inside(self, permission: Permission, routes: UtoipaMethodRouter<Arc<Context>>) -> Self {
        self.mount(Access::NeedsInside(permission), routes)
    }

    /// Mounts a page of the console, which is not of the API.
    pub fn page(mut self, page: &'static Page) -> Self {
        self.table.of_route.insert((Method::GET, page.path.clone()), Access::Page);
        let answer = move |asked: HeaderMap| async move { page.answer(&asked) };
        self.router = self.router.route(&page.path, axum::routing::get(answer));
        self
    }

    fn mount(
        mut self,
        access: Access,
        (schemas, mut paths, handlers): UtoipaMethodRouter<Arc<Context>>,
    ) -> Self {
        for (path, item) in &mut paths.paths {
            let operations = [
                (Method::GET, &mut item.get),
                (Method::PUT, &mut item.put),
                (Method::POST, &mut item.post),
                (Method::DELETE, &mut item.delete),
                (Method::PATCH, &mut item.patch),
            ];
            for (method, operation) in operations {
                let Some(operation) = operation else { continue };
                describe(access, operation);
                operation.operation_id = Some(operation_id(&method, path));
                self.table.of_route.insert((method, path.clone()), access);
            }
        }
        self.router = self.router.routes((schemas, paths, handlers));
        self
    }

    /// The router, the file of the API and the table.
    pub fn finish(self) -> (axum::Router<Arc<Context>>, OpenApi, AccessTable) {
        let (router, openapi) = self.router.split_for_parts();
        (router, openapi, self.table)
    }
}

/// `get_tags_tag_following`: no two operations have the same method and path, so no two have the same id. Clients made of the file
/// name their functions so.
fn operation_id(method: &Method, path: &str) -> String {
    let path = path.strip_prefix("/api/v1").unwrap_or(path);
    let parts = path.split(|c: char| !c.is_ascii_alphanumeric()).filter(|part| !part.is_empty());
    parts.fold(method.as_str().to_ascii_lowercase(), |id, part| id + "_" + part)
}

/// Writes into the file of the API what the route needs and how it refuses.
fn describe(access: Access, operation: &mut Operation) {
    let responses = &mut operation.responses.responses;
    responses.insert("default".into(), RefOr::T(problem("not done: `message` says why")));
    let Some(permission) = (match access {
        Access::Open | Access::Page => None,
        Access::Needs(permission) | Access::NeedsInside(permission) => Some(permission),
    }) else {
        operation.security = Some(Vec::new());
        return;
    };
    let none: [&str; 0] = [];
    operation.security =
        Some(vec![SecurityRequirement::new("bearer", none), SecurityRequirement::new("session", none)]);
    responses.insert("401".into(), RefOr::T(problem("no valid session or token")));
    responses.insert("403".into(), RefOr::T(problem("not with this role")));
    let extensions = operation.extensions.get_or_insert_default();
    extensions.insert("x-adit-permission".into(), permission.name().into());
    extensions.insert("x-adit-role".into(), permission.least_role().name().into());
}

fn problem(description: &str) -> Response {
    let content = ContentBuilder::new().schema(Some(Ref::from_schema_name("Problem"))).build();
    ResponseBuilder::new().description(description).content("application/json", content).build()
}
