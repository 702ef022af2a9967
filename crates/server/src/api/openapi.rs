//! The file of the API, made of the code.

use super::Problem;
use axum::Json;
use std::sync::OnceLock;
use utoipa::openapi::security::{ApiKey, ApiKeyValue, Http, HttpAuthScheme, SecurityScheme};
use utoipa::openapi::{ComponentsBuilder, InfoBuilder, OpenApi, OpenApiBuilder};
use utoipa::{PartialSchema as _, ToSchema as _};

/// What stands before the routes.
pub(super) fn frame() -> OpenApi {
    let info = InfoBuilder::new()
        .title("adit")
        .version(env!("CARGO_PKG_VERSION"))
        .description(Some(
            "Where every person underground is. Positions are on the mine's grid (east, north, height), m; times RFC 3339 in UTC. \
             Every operation names the permission that it needs (`x-adit-permission`) and the least role that has it (`x-adit-role`).",
        ))
        .license(Some(utoipa::openapi::LicenseBuilder::new().name("MIT OR Apache-2.0").build()))
        .build();
    let components = ComponentsBuilder::new()
        .schema(Problem::name(), Problem::schema())
        .security_scheme("bearer", SecurityScheme::Http(Http::new(HttpAuthScheme::Bearer)))
        .security_scheme(
            "session",
            SecurityScheme::ApiKey(ApiKey::Cookie(ApiKeyValue::new(super::guard::COOKIE))),
        )
        .build();
    OpenApiBuilder::new().info(info).components(Some(components)).build()
}

/// The file of the API.
pub fn document() -> OpenApi {
    super::all_routes().finish().1
}

/// This file.
#[utoipa::path(get, path = "/api/v1/openapi.json", tag = "api", responses(
    (status = 200, description = "OpenAPI 3.1", body = serde_json::Value),
))]
pub(super) async fn openapi() -> Json<&'static OpenApi> {
    static DOCUMENT: OnceLock<OpenApi> = OnceLock::new();
    Json(DOCUMENT.get_or_init(document))
}
