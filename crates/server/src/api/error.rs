//! What the API answers when it does not do what was asked: always JSON, `{type, code, message}`, as omlox has it.

use crate::auth::AuthError;
use crate::ingest::{CommandError, DoorError};
use crate::seldom::Seldom;
use crate::store::StoreError;
use adit_tracking::Refused;
use axum::Json;
use axum::http::{HeaderValue, StatusCode, header};
use axum::response::{IntoResponse, Response};
use serde::{Deserialize, Serialize};
use std::path::Path;
use utoipa::ToSchema;

/// Why it was not done.
#[derive(Debug, Clone, Serialize, Deserialize, ToSchema)]
pub struct Problem {
    /// Kind of problem, for programs.
    #[serde(rename = "type")]
    #[schema(example = "not-found")]
    pub kind: String,
    /// The HTTP status.
    #[schema(example = 404)]
    pub code: u16,
    /// What was found and what was expected, for people.
    #[schema(example = "no person `p9`")]
    pub message: String,
}

/// A problem on its way out.
#[derive(Debug)]
pub struct ApiError {
    status: StatusCode,
    kind: &'static str,
    message: String,
    retry_after_s: Option<u64>,
}

impl ApiError {
    fn new(status: StatusCode, kind: &'static str, message: impl Into<String>) -> Self {
        Self { status, kind, message: message.into(), retry_after_s: None }
    }

    /// 400: cannot be read.
    pub fn malformed(message: impl Into<String>) -> Self {
        Self::new(StatusCode::BAD_REQUEST, "malformed", message)
    }

    /// 401: who asks?
    pub fn unauthorised() -> Self {
        let message =
            "no valid session or token: log in at POST /api/v1/session, or send `Authorization: Bearer …`";
        Self::new(StatusCode::UNAUTHORIZED, "unauthorised", message)
    }

    /// 403: not with this role.
    pub fn forbidden(message: impl Into<String>) -> Self {
        Self::new(StatusCode::FORBIDDEN, "forbidden", message)
    }

    /// 404: there is none.
    pub fn not_found(message: impl Into<String>) -> Self {
        Self::new(StatusCode::NOT_FOUND, "not-found", message)
    }

    /// 405: not with this method.
    pub fn method_not_allowed(message: impl Into<String>) -> Self {
        Self::new(StatusCode::METHOD_NOT_ALLOWED, "method-not-allowed", message)
    }

    /// 409: not as things stand.
    pub fn conflict(message: impl Into<String>) -> Self {
        Self::new(StatusCode::CONFLICT, "conflict", message)
    }

    /// 413: too long.
    pub fn too_large(message: impl Into<String>) -> Self {
        Self::new(StatusCode::PAYLOAD_TOO_LARGE, "too-large", message)
    }

    /// 415: not of this type.
    pub fn unsupported_media_type(message: impl Into<String>) -> Self {
        Self::new(StatusCode::UNSUPPORTED_MEDIA_TYPE, "unsupported-media-type", message)
    }

    /// 422: read, but it cannot be.
    pub fn invalid(message: impl Into<String>) -> Self {
        Self::new(StatusCode::UNPROCESSABLE_ENTITY, "invalid", message)
    }

    /// 503: not now; try again after so many seconds.
    pub fn unavailable(message: impl Into<String>, retry_after_s: u64) -> Self {
        let mut error = Self::new(StatusCode::SERVICE_UNAVAILABLE, "unavailable", message);
        error.retry_after_s = Some(retry_after_s);
        error
    }

    /// 500: a fault of the server or its disk; the log tells it, the answer does not.
    pub fn internal(error: &dyn std::error::Error) -> Self {
        tracing::error!("API: {error}");
        let message = "an error of the server; its log says which";
        Self::new(StatusCode::INTERNAL_SERVER_ERROR, "internal", message)
    }

    /// The HTTP status.
    pub fn status(&self) -> StatusCode {
        self.status
    }

    /// As it is sent.
    pub fn problem(&self) -> Problem {
        Problem { kind: self.kind.into(), code: self.status.as_u16(), message: self.message.clone() }
    }
}

impl IntoResponse for ApiError {
    fn into_response(self) -> Response {
        let mut response = (self.status, Json(self.problem())).into_response();
        if self.status == StatusCode::UNAUTHORIZED {
            response.headers_mut().insert(header::WWW_AUTHENTICATE, HeaderValue::from_static("Bearer"));
        }
        if let Some(seconds) = self.retry_after_s {
            response.headers_mut().insert(header::RETRY_AFTER, seconds.into());
        }
        response
    }
}

impl From<AuthError> for ApiError {
    fn from(error: AuthError) -> Self {
        let message = error.to_string();
        match error {
            AuthError::WrongCredentials => Self::new(StatusCode::UNAUTHORIZED, "wrong-credentials", message),
            AuthError::TooManyTries { wait_s } => Self {
                retry_after_s: Some(wait_s),
                ..Self::new(StatusCode::TOO_MANY_REQUESTS, "too-many-tries", message)
            },
            AuthError::PasswordLength { .. } | AuthError::Name { .. } | AuthError::Expired { .. } => {
                Self::invalid(message)
            }
            AuthError::Taken { .. } | AuthError::LastAdmin { .. } => Self::conflict(message),
            AuthError::Unknown { .. } => Self::not_found(message),
            AuthError::Store(error) => Self::of_store(&error),
            AuthError::Database(error) => Self::of_store(&StoreError::of(Path::new("users"), &error)),
            AuthError::Random(_) | AuthError::Hash(_) | AuthError::Role { .. } => Self::internal(&error),
        }
    }
}

impl ApiError {
    /// Of the store.
    pub(super) fn of_store(error: &StoreError) -> Self {
        static LATER: Seldom = Seldom::new();
        if error.may_be_tried_again() {
            LATER.warn(format_args!("API: {error}"));
            Self::unavailable("the store cannot be written or read now", 5)
        } else {
            Self::internal(error)
        }
    }
}

impl ApiError {
    /// Of another part of the server.
    pub(super) fn of_server(error: &crate::ServerError) -> Self {
        match error {
            crate::ServerError::Store(error) => Self::of_store(error),
            other => Self::internal(other),
        }
    }
}

impl From<DoorError> for ApiError {
    fn from(error: DoorError) -> Self {
        let message = error.to_string();
        match error {
            DoorError::TooLong { .. } => Self::too_large(message),
            DoorError::Bad(_) | DoorError::Json(_) | DoorError::Name { .. } | DoorError::Number { .. } => {
                Self::invalid(message)
            }
            DoorError::Busy | DoorError::NotStored(_) | DoorError::NoAnswer => Self::unavailable(message, 5),
        }
    }
}

impl From<CommandError> for ApiError {
    fn from(error: CommandError) -> Self {
        match error {
            CommandError::Door(error) => error.into(),
            CommandError::Refused(refused) => {
                let message = refused.to_string();
                match refused {
                    Refused::UnknownPerson { .. }
                    | Refused::UnknownTag { .. }
                    | Refused::UnknownZone { .. }
                    | Refused::UnknownAlarm { .. }
                    | Refused::UnknownDevice { .. } => Self::not_found(message),
                    Refused::UnknownLevel { .. }
                    | Refused::BadId { .. }
                    | Refused::BadOutline { .. }
                    | Refused::BadNumber { .. }
                    | Refused::TooLong { .. }
                    | Refused::EndsBeforeItBegins { .. }
                    | Refused::Rules(_) => Self::invalid(message),
                    _ => Self::conflict(message),
                }
            }
        }
    }
}
