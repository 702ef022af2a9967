// Made by `npm run api-types` of the server's /api/v1/openapi.json. Not edited by hand.

export type paths = Record<string, never>;
export type webhooks = Record<string, never>;
export interface components {
    schemas: {
        /** @description An alarm. */
        Alarm: {
            /** @description `person`, `tag`, `zone`, `gateway`, `anchor` or `mine`. */
            about: string;
            /** @description Whose id; null for the mine. */
            about_id?: string | null;
            acknowledged?: components["schemas"]["Deed"] | null;
            cleared?: components["schemas"]["Deed"] | null;
            /**
             * Format: int32
             * @description How often it was escalated.
             */
            escalation: number;
            /**
             * Format: int64
             * @description Its number.
             */
            id: number;
            /** @description What is wrong: `distress`, `man-down`, `lost-contact` … */
            kind: string;
            notes: components["schemas"]["Note"][];
            /** @description Last known position when it was raised, m. */
            position_m?: number[] | null;
            raised: components["schemas"]["Timestamp"];
            /** @description `low`, `medium`, `high` or `critical`. */
            severity: string;
            /** @description Since when what it tells was so. */
            since: components["schemas"]["Timestamp"];
            /** @description `raised`, `acknowledged` or `cleared`. */
            state: string;
            /** @description Where, for alarms of zones. */
            zone?: string | null;
        };
        /** @description Alarms, the last raised first. */
        AlarmPage: {
            /** @description `after` for the next page; null at the end. */
            next?: string | null;
            rows: components["schemas"]["Alarm"][];
        };
        /** @description Alarms as they stand. */
        Alarms: {
            /** @description The last thousand that were cleared, the latest last. Older ones: `/api/v1/history/alarms`. */
            cleared: components["schemas"]["Alarm"][];
            /** @description In the order in which they were raised. */
            open: components["schemas"]["Alarm"][];
        };
        /** @description An anchor of the plan. */
        Anchor: {
            id: string;
            in_force: components["schemas"]["InForce"];
            /** @description Its name for people. */
            name?: string | null;
            /** @description East, north, height, m; null when it is taken away. */
            position_m?: number[] | null;
            /** @description Where it is for the server as it runs; null where it is not known yet. */
            position_now_m?: number[] | null;
        };
        /** @description Where an anchor is. */
        AnchorPlace: {
            /** @description Its name for people. */
            name?: string | null;
            /** @description East, north, height, m. */
            position_m: number[];
        };
        /** @description Who is to wear a tag. */
        Assign: {
            from?: components["schemas"]["Timestamp"] | null;
            /** @description Id of the person. */
            person: string;
            until?: components["schemas"]["Timestamp"] | null;
        };
        /** @description Who wears a tag from when until when. */
        Assignment: {
            from: components["schemas"]["Timestamp"];
            person: string;
            tag: string;
            until?: components["schemas"]["Timestamp"] | null;
        };
        /** @description A row of the audit log. */
        AuditRow: {
            detail: unknown;
            /** Format: int64 */
            number: number;
            outcome: string;
            source: string;
            time: components["schemas"]["Timestamp"];
            what: string;
            who: string;
        };
        /** @description A copy of the store. */
        Backup: {
            /** Format: int64 */
            bytes: number;
            /** @description Its file, in `backups` of the data folder. */
            name: string;
            /** @description When it was done. */
            time: components["schemas"]["Timestamp"];
        };
        /** @description How full a battery is. */
        Battery: {
            /**
             * Format: double
             * @description 0 to 1, where the tag tells it.
             */
            share?: number | null;
            /** @description When that was measured. */
            time: components["schemas"]["Timestamp"];
            /**
             * Format: double
             * @description V, where the tag tells it.
             */
            volts?: number | null;
        };
        /** @description The evacuation that runs, if any. */
        Board: {
            evacuation?: components["schemas"]["Evacuation"] | null;
        };
        /** @description The time of the mine. */
        Clock: {
            /**
             * Format: double
             * @description Seconds of the mine in a second of the wall: 1, but for a simulated shift.
             */
            clock_speed: number;
            /** @description The shift is simulated. */
            simulated: boolean;
            /** @description Now. */
            time: components["schemas"]["Timestamp"];
        };
        /** @description What is to be said to an alarm. */
        Comment: {
            text: string;
        };
        /** @description How many are in a place. */
        Count: {
            /** Format: int32 */
            assets: number;
            /** Format: int32 */
            people: number;
            /**
             * Format: int32
             * @description Tags for people that nobody is known to wear.
             */
            unassigned_tags: number;
            /** Format: int32 */
            vehicles: number;
        };
        /** @description When something was done, and by whom. */
        Deed: {
            at: components["schemas"]["Timestamp"];
            /** @description Null when the condition went by itself. */
            by?: string | null;
        };
        /** @description A gateway or an anchor. */
        Device: {
            id: string;
            /** @description `gateway` or `anchor`. */
            kind: string;
            /** @description Since when. */
            since: components["schemas"]["Timestamp"];
            /** @description It works. */
            up: boolean;
        };
        /** @description An evacuation as it stands. */
        Evacuation: {
            by: string;
            /** Format: int64 */
            id: number;
            /** @description Levels to leave; the whole mine where it is empty. */
            levels: string[];
            note: string;
            people: components["schemas"]["Evacuee"][];
            /**
             * Format: double
             * @description For how long it runs, s.
             */
            running_s: number;
            since: components["schemas"]["Timestamp"];
            summary: components["schemas"]["EvacuationSummary"];
        };
        /** @description How many stand how. */
        EvacuationSummary: {
            /** Format: int32 */
            in_refuge: number;
            /**
             * Format: int32
             * @description Of the last three: expected to be safe by now.
             */
            missing: number;
            /** Format: int32 */
            moving_out: number;
            /** Format: int32 */
            not_moving: number;
            /** Format: int32 */
            other_level: number;
            /** Format: int32 */
            out: number;
            /** Format: int32 */
            unknown: number;
        };
        /** @description Somebody who was below when the evacuation began, or since. */
        Evacuee: {
            last_known?: components["schemas"]["Where"] | null;
            /** @description Expected to be safe by now. */
            missing: boolean;
            /**
             * Format: double
             * @description By how much the way has become shorter since the evacuation began, m.
             */
            nearer_by_m?: number | null;
            person?: string | null;
            since: components["schemas"]["Timestamp"];
            /** @description `out`, `other-level`, `in-refuge`, `moving-out`, `not-moving` or `unknown`. */
            status: string;
            tag?: string | null;
            to_portal?: components["schemas"]["Way"] | null;
            to_refuge?: components["schemas"]["Way"] | null;
        };
        /** @description Something that happened. As the store keeps it and as viewers see it. */
        Event: {
            alarm?: components["schemas"]["Alarm"] | null;
            /**
             * Format: int64
             * @description Number of the alarm.
             */
            alarm_id?: number | null;
            /** @description By whom. */
            by?: string | null;
            comment?: components["schemas"]["Note"] | null;
            /** @description Id of the device. */
            device?: string | null;
            /** @description `gateway` or `anchor`. */
            device_kind?: string | null;
            entered?: components["schemas"]["Timestamp"] | null;
            /**
             * Format: int64
             * @description Number of the evacuation.
             */
            evacuation?: number | null;
            /**
             * @description What: `zone-entered`, `zone-left`, `level-changed`, `went-below`, `came-out`, `contact-lost`, `contact-regained`, `tag-appeared`,
             *     `tag-assigned`, `tag-returned`, `device-down`, `device-up`, `alarm-raised`, `alarm-escalated`, `alarm-acknowledged`,
             *     `alarm-commented`, `alarm-cleared`, `evacuation-started`, `evacuation-stopped`.
             */
            event: string;
            /** @description Level before. */
            from_level?: string | null;
            /** @description What kind of tag they are followed by. */
            kind?: string | null;
            /** @description How it is known: `crossed`, `appeared`, `vanished`, `commanded`, `portal`. */
            known_by?: string | null;
            last_heard?: components["schemas"]["Timestamp"] | null;
            /** @description Levels to leave. */
            levels?: string[] | null;
            /** @description Why, or how it ended. */
            note?: string | null;
            /** @description Id of the person. */
            person?: string | null;
            shift_since?: components["schemas"]["Timestamp"] | null;
            summary?: components["schemas"]["EvacuationSummary"] | null;
            /** @description Id of the tag. */
            tag?: string | null;
            time?: components["schemas"]["Timestamp"] | null;
            /** @description Level after. */
            to_level?: string | null;
            /** @description Id of the zone. */
            zone?: string | null;
        };
        /** @description Events, newest first. */
        EventPage: {
            /** @description `after` for the next page; null at the end. */
            next?: string | null;
            rows: components["schemas"]["Event"][];
        };
        /** @description How a tag is followed. */
        Following: {
            /**
             * Format: double
             * @description What is added to the stamps of its clock, s.
             */
            clock_shift_s: number;
            /** @description Packets and observations: taken, repeated, late, refused; fixes told. */
            counts: unknown;
            /** @description Whom the tag heard in its last minute, or who heard it, by name; at most 16. */
            heard: components["schemas"]["HeardSource"][];
            innovations?: components["schemas"]["Innovations"] | null;
            /** @description Whether ranges are judged for line of sight, as its profile has it. */
            judged: boolean;
            /** @description The last error of the method. */
            last_error?: string | null;
            /** @description Name of the method. */
            method: string;
            /** @description What the method says of its run: what it heard, innovations, warnings. */
            method_report: unknown;
            /** @description Name of its profile in the settings. */
            profile: string;
            /** @description What the tag sends. */
            sensors: components["schemas"]["SensorRate"][];
            /** @description The tag. */
            tag: string;
        };
        /**
         * @description What a session or a token is good for.
         * @enum {string}
         */
        Grant: "viewer" | "dispatcher" | "safety-officer" | "admin" | "ingest";
        /** @description How many are where. */
        Headcount: {
            levels: components["schemas"]["PlaceCount"][];
            /** @description Below. */
            mine: components["schemas"]["Count"];
            /**
             * Format: int32
             * @description Below and not heard of: part of `mine`.
             */
            out_of_contact: number;
            zones: components["schemas"]["PlaceCount"][];
        };
        /** @description How the server is. */
        HealthReport: {
            parts: components["schemas"]["PartHealth"][];
            /** @description All parts that are used work. */
            ready: boolean;
        };
        /** @description The last that an anchor or access point told of a tag. */
        HeardSource: {
            /** @description Id of the anchor or access point of the plan that it is; null where the plan has none. */
            anchor?: string | null;
            innovation?: components["schemas"]["Innovation"] | null;
            /** @description `range` or `signal`. */
            kind: string;
            /**
             * Format: double
             * @description Probability that the signal came straight, as judged live; null where nothing judged it.
             */
            line_of_sight?: number | null;
            /**
             * Format: double
             * @description The distance as measured, m.
             */
            range_m?: number | null;
            /**
             * Format: double
             * @description The signal strength, dBm.
             */
            rssi_dbm?: number | null;
            /** @description Its name as the tag has it: an id, or a MAC address. */
            source: string;
            /** @description When, by the server's clock. */
            time: components["schemas"]["Timestamp"];
        };
        /**
         * @description When a change is in force.
         * @enum {string}
         */
        InForce: "now" | "at the next start";
        /** @description What a method made of a range or a signal strength. */
        Innovation: {
            /** @description Whether it counted in full: was neither refused nor weighed down. */
            believed: boolean;
            /**
             * Format: double
             * @description The same squared over its predicted variance; 1 in the mean where the method knows its errors.
             */
            nis: number;
            /**
             * Format: double
             * @description Measured less expected: m of a range, dB of a signal strength.
             */
            residual: number;
            /** @description Of which time. */
            time: components["schemas"]["Timestamp"];
        };
        /** @description Innovations of ten seconds. */
        InnovationBin: {
            /**
             * Format: int64
             * @description Degrees of freedom in that mean.
             */
            count: number;
            /**
             * Format: double
             * @description Mean for each degree of freedom, of what counted in full; null where nothing did.
             */
            mean_nis?: number | null;
            /**
             * Format: int64
             * @description Measurements that did not count in full.
             */
            outliers: number;
        };
        /** @description Normalised innovations squared in bins of time. */
        Innovations: {
            /**
             * Format: int64
             * @description Length of a bin, s.
             */
            bin_s: number;
            /** @description Oldest first, 60. */
            bins: components["schemas"]["InnovationBin"][];
            /** @description End of the last bin, by the tag's time. */
            until: components["schemas"]["Timestamp"];
        };
        /** @description Somebody, or a tag that nobody is known to wear, as is known now. */
        Live: {
            /** @description Numbers of the open alarms about them. */
            alarms: number[];
            /** @description By which gateway. */
            gateway?: string | null;
            /** @description One of their tags is heard. */
            in_contact: boolean;
            /** @description `person`, `vehicle` or `asset`: what kind of tag they are followed by. */
            kind: string;
            last_heard?: components["schemas"]["Timestamp"] | null;
            last_known?: components["schemas"]["Where"] | null;
            motion?: components["schemas"]["Motion"] | null;
            /** @description Id of the person. */
            person?: string | null;
            /** @description Zones that they may be in: nobody can tell. */
            possible_zones: string[];
            since?: components["schemas"]["Timestamp"] | null;
            /** @description `below`, `out` or `unseen`. */
            state: string;
            /** @description Id of the tag that nobody is known to wear. */
            tag?: string | null;
            /** @description Zones that they are in. */
            zones: components["schemas"]["Stay"][];
        };
        /** @description A session begun. */
        LoggedIn: {
            /** @description When the session ends at the latest. */
            expires: components["schemas"]["Timestamp"];
            name: string;
            role: components["schemas"]["Role"];
            /** @description To be sent as `Authorization: Bearer …` by programs; browsers have it in the cookie. */
            token: string;
        };
        /** @description Who wants in. */
        Login: {
            /** @example admin */
            name: string;
            /** Format: password */
            password: string;
        };
        /** @description A token just made, with its secret, which is told once. */
        MadeToken: {
            secret: string;
            token: components["schemas"]["Token"];
        };
        /** @description Who one is. */
        Me: {
            expires?: components["schemas"]["Timestamp"] | null;
            grant: components["schemas"]["Grant"];
            name: string;
            /** @description What one may do. */
            permissions: string[];
        };
        /** @description Whether somebody moves. */
        Motion: {
            /** @description What is known of it. */
            motion: string;
            /** @description Since when without a break. */
            since: components["schemas"]["Timestamp"];
        };
        /** @description A token to be made. */
        NewToken: {
            expires?: components["schemas"]["Timestamp"] | null;
            grant: components["schemas"]["Grant"];
            name: string;
        };
        /** @description A user to be added. */
        NewUser: {
            name: string;
            /** Format: password */
            password: string;
            role: components["schemas"]["Role"];
        };
        /** @description What somebody said to an alarm. */
        Note: {
            at: components["schemas"]["Timestamp"];
            by: string;
            text: string;
        };
        /** @description Packets that came of a tag. */
        Packets: {
            /** @description First and last of each span of its own packet numbers. */
            numbers: number[][];
            /** @description The tag. */
            tag: string;
        };
        /**
         * @description A part of the server that can fail by itself.
         * @enum {string}
         */
        Part: "journal" | "store" | "broker";
        /** @description How one part is. */
        PartHealth: {
            ok: boolean;
            part: components["schemas"]["Part"];
        };
        /** @description The old and the new password. */
        PasswordChange: {
            /** Format: password */
            new: string;
            /** Format: password */
            old: string;
        };
        /** @description Somebody who may go below, as entered. */
        Person: {
            /** @description Ids of the restricted zones that they may enter. */
            allowed_zones?: string[];
            /** @description How to reach them or their next of kin. */
            contact?: string | null;
            /** @description A number of the staff, say. */
            id: string;
            name: string;
            /** @description The shift they work in, as the mine calls it. */
            shift?: string | null;
            /**
             * Format: double
             * @description How long they may be below, h; the rule's where it is not given.
             */
            shift_limit_h?: number | null;
            team?: string | null;
        };
        /** @description A person with all that is known. */
        PersonNow: {
            /** @description Where they are. */
            live: components["schemas"]["Live"];
            /** @description As entered. */
            person: components["schemas"]["Person"];
            /** @description Ids of the tags they wear. */
            tags: string[];
        };
        /** @description How many are in one place. */
        PlaceCount: {
            count: components["schemas"]["Count"];
            id: string;
        };
        /** @description A point of `GeoJSON`: east or longitude, north or latitude, height. */
        Point: {
            coordinates: number[];
            type: string;
        };
        /** @description Why it was not done. */
        Problem: {
            /**
             * Format: int32
             * @description The HTTP status.
             * @example 404
             */
            code: number;
            /**
             * @description What was found and what was expected, for people.
             * @example no person `p9`
             */
            message: string;
            /**
             * @description Kind of problem, for programs.
             * @example not-found
             */
            type: string;
        };
        /** @description A location as a client puts it; `source`, `provider_type` and other members are taken and not read. */
        PutLocation: {
            /**
             * Format: double
             * @description Radius that holds it with 95 %, m.
             */
            accuracy?: number | null;
            /** @description `local` where it is not given. */
            crs?: string | null;
            /** @description `floor`: the height counts from the floor of the level. */
            elevation_ref?: string | null;
            /**
             * Format: double
             * @description 0 for the highest level, −1 for the one below.
             */
            floor?: number | null;
            position: components["schemas"]["Point"];
            provider_id?: string | null;
            timestamp_generated?: components["schemas"]["Timestamp"] | null;
        };
        /** @description What somebody says to what they do. */
        Remark: {
            note?: string;
        };
        /** @description Where everybody was. */
        Replay: {
            from: components["schemas"]["Timestamp"];
            /** @description One entry for each tag and person who wore it. */
            people: components["schemas"]["ReplayTrack"][];
            /** Format: double */
            step_s: number;
            until: components["schemas"]["Timestamp"];
        };
        /** @description Where somebody was: columns of the same length. */
        ReplayTrack: {
            /** @description Id of the level. */
            level: (string | null)[];
            /** @description Null while nobody wore the tag. */
            person?: string | null;
            /** @description East, north, height, m. */
            position_m: number[][];
            /** @description `fixed`, `dead-reckoning` or `lost`. */
            quality: string[];
            radius_95_m: number[];
            tag: string;
            /** @description After `from`, rising, s. */
            time_s: number[];
        };
        /**
         * @description What a user is trusted with; each role may do all that those before it may.
         * @enum {string}
         */
        Role: "viewer" | "dispatcher" | "safety-officer" | "admin";
        /** @description A kind of observations that a tag sends. */
        SensorRate: {
            /** @description `imu` (gyro and accelerometer), `acceleration`, `magnetic`, `pressure`, `fix`, `signal`, `range`, `sighting`. */
            kind: string;
            /**
             * Format: double
             * @description How many a second, over its last 10 to 20 s.
             */
            per_s: number;
        };
        /** @description Another speed. */
        SetClock: {
            /**
             * Format: double
             * @description Above 0, to 100.
             */
            clock_speed: number;
        };
        /** @description A shift of somebody. */
        Shift: {
            came_out?: components["schemas"]["Timestamp"] | null;
            /** Format: double */
            hours: number;
            person?: string | null;
            tag?: string | null;
            went_below: components["schemas"]["Timestamp"];
        };
        /** @description Which levels, and why. */
        StartEvacuation: {
            /** @description Ids of the levels to leave; the whole mine where it is empty. */
            levels?: string[];
            note?: string;
        };
        /** @description A zone that somebody is in. */
        Stay: {
            since: components["schemas"]["Timestamp"];
            zone: string;
        };
        /** @description What became of a batch: it is on the disk. */
        Stored: {
            /**
             * Format: int64
             * @description Entry of the journal that holds it; null when it had come before.
             */
            position?: number | null;
            /** @description It had come before. */
            repeated: boolean;
        };
        /** @description A tag as entered. */
        Tag: {
            /** @description As the tag sends it. */
            id: string;
            /** @description What it is for; people where it is not given. */
            kind?: components["schemas"]["TagKind"];
            /** @description Name for people: the number of a vehicle, say. */
            name?: string | null;
            worn?: components["schemas"]["Worn"] | null;
        };
        /**
         * @description What a tag is for.
         * @enum {string}
         */
        TagKind: "person" | "vehicle" | "asset";
        /** @description A tag with all that is known. */
        TagNow: {
            /** @description This assignment and those to come. */
            assignments: components["schemas"]["Assignment"][];
            battery?: components["schemas"]["Battery"] | null;
            /** @description By which gateway. */
            gateway?: string | null;
            /** @description It is heard. */
            in_contact: boolean;
            last_heard?: components["schemas"]["Timestamp"] | null;
            last_known?: components["schemas"]["Where"] | null;
            motion?: components["schemas"]["Motion"] | null;
            /** @description Who wears it now. */
            person?: string | null;
            /** @description Somebody has entered it; else it was only heard. */
            registered: boolean;
            /** @description As entered. */
            tag: components["schemas"]["Tag"];
        };
        /** Format: date-time */
        Timestamp: string;
        /** @description An API token without its secret. */
        Token: {
            created: components["schemas"]["Timestamp"];
            created_by: string;
            expires?: components["schemas"]["Timestamp"] | null;
            grant: components["schemas"]["Grant"];
            id: string;
            name: string;
            /** @description How the secret begins. */
            prefix: string;
            revoked?: components["schemas"]["Timestamp"] | null;
        };
        /** @description A track for a map. */
        Track: {
            /**
             * Format: double
             * @description No fix left out is farther than this from the line drawn, m.
             */
            error_m: number;
            /** @description In order of time; the first and the last are among them. */
            fixes: components["schemas"]["TrackFix"][];
            /**
             * Format: int64
             * @description How many there are in all.
             */
            of: number;
        };
        /** @description A fix of a track. */
        TrackFix: {
            level?: string | null;
            person?: string | null;
            position_m: number[];
            quality: string;
            /** Format: double */
            radius_95_m: number;
            tag: string;
            time: components["schemas"]["Timestamp"];
            zone?: string | null;
        };
        /** @description A user. */
        User: {
            created: components["schemas"]["Timestamp"];
            /** @description May not log in. */
            disabled: boolean;
            locked_until?: components["schemas"]["Timestamp"] | null;
            name: string;
            role: components["schemas"]["Role"];
        };
        /** @description What is to be changed; what is missing stays. */
        UserChangeJson: {
            disabled?: boolean | null;
            /**
             * Format: password
             * @description A new password; it also unlocks.
             */
            password?: string | null;
            role?: components["schemas"]["Role"] | null;
        };
        /** @description What the log looks like. */
        Verification: {
            /** @description On what the first row stands: number 0, or the last row that retention took away. */
            anchor: string;
            /** @description The first thing that does not fit. */
            broken?: string | null;
            /** @description The end of the chain. Written down elsewhere it shows, later, a log that was made anew. */
            head: string;
            /**
             * Format: int64
             * @description Rows that fit, from the first.
             */
            rows: number;
            /** @description Every row is as it was written. */
            sound: boolean;
            /** @description Heads given whose rows retention took away: nothing can be said of them. */
            too_old: string[];
        };
        /** @description The shortest way on foot. */
        Way: {
            /**
             * Format: double
             * @description Along the roadways from the last known position, m.
             */
            length_m: number;
            /** @description Zone where it ends. */
            zone: string;
        };
        /** @description The last that is known of where somebody is. */
        Where: {
            /**
             * Format: double
             * @description For how long nothing newer has come, s.
             */
            age_s: number;
            /** @description Id of the level. */
            level?: string | null;
            /** @description Method or system that says so. */
            method: string;
            /** @description East, north, height on the mine's grid, m. */
            position_m: number[];
            /**
             * Format: double
             * @description Radius outside which they are with a probability of 10⁻³ at most, m.
             */
            protection_level_m: number;
            /** @description `fixed`, `dead-reckoning` or `lost`. */
            quality: string;
            /**
             * Format: double
             * @description Radius that held them then with 95 % probability, m.
             */
            radius_95_m: number;
            /**
             * Format: double
             * @description Radius that holds them now: grown by the way that they may have gone since, m.
             */
            radius_now_m: number;
            /** @description The tag that says so. */
            tag: string;
            /** @description When. */
            time: components["schemas"]["Timestamp"];
            /** @description East, north, up, m/s. */
            velocity_m_s?: number[] | null;
        };
        /** @description A person, else a tag that nobody is known to wear. */
        Who: {
            person?: string | null;
            tag?: string | null;
        };
        /**
         * @description Where a tag is worn.
         * @enum {string}
         */
        Worn: "foot" | "waist" | "helmet" | "chest" | "wrist" | "pocket";
        /** @description A zone as it is watched. */
        Zone: {
            /** @description Teams whose people may enter it when it is restricted. */
            allowed_teams?: string[];
            /**
             * Format: int64
             * @description How many people it may hold.
             */
            capacity?: number | null;
            /**
             * Format: double
             * @description Who was inside is outside only after this long beyond the tolerance, s.
             */
            exit_delay_s?: number;
            /**
             * Format: double
             * @description Who was inside is outside only when this far from it, m.
             */
            exit_tolerance_m?: number;
            id: string;
            kind: components["schemas"]["ZoneKind"];
            /** @description Id of the level it lies on. */
            level: string;
            name?: string | null;
            /** @description Corners east, north, in order round the zone, the first not repeated, m. */
            outline_m: number[][];
        };
        /**
         * @description What a zone means.
         * @enum {string}
         */
        ZoneKind: "restricted" | "dangerous" | "key" | "refuge" | "portal";
        /** @description A zone and who is in it. */
        ZoneNow: {
            count: components["schemas"]["Count"];
            inside: components["schemas"]["Who"][];
            /** @description Who may be in it: their last fix was too coarse to tell. */
            possible: components["schemas"]["Who"][];
            /** @description The zone as it is watched. */
            zone: components["schemas"]["Zone"];
        };
    };
    responses: never;
    parameters: never;
    requestBodies: never;
    headers: never;
    pathItems: never;
}
export type $defs = Record<string, never>;
export type operations = Record<string, never>;
