import "./styles/tokens.css";
import "./styles/base.css";
import { mount } from "svelte";
import App from "./App.svelte";
import { keepPreferences } from "./app/preferences.svelte";
import { followAddress } from "./app/router.svelte";
import { begin } from "./app/session.svelte";

keepPreferences();
followAddress();
void begin();

const target = document.getElementById("app");
if (target) mount(App, { target });
