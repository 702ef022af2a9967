/** Positions of a span from the server: of everybody at once, else, of an older server, person by person. */
import { ApiError, api, part } from "../../api/client";
import type { Alarm, AlarmPage, HistoryPositions, PersonNow, Shift, Track } from "../../api/types";
import { courseOfTrack, coursesOf, type Course } from "../../live/history";
import { keyOf } from "../../live/subject";

/** Steps that are tried, s: the next one when the server says that it would be too much. */
const STEPS_S = [1, 2, 5, 10, 30, 60, 120];
/** Without the answer for all: tracks of so many. */
const TRACKS = 150;
const AT_ONCE = 6;

export interface Span {
  from: number;
  until: number;
}

const iso = (time: number) => new Date(time).toISOString();

export async function loadCourses(span: Span): Promise<{ courses: Course[]; step: number | null }> {
  const query = { from: iso(span.from), until: iso(span.until) };
  const wished = (span.until - span.from) / 3_600_000;
  for (const step of STEPS_S.filter((it) => it >= Math.min(wished, 60))) {
    try {
      const history = await api.get<HistoryPositions>("/api/v1/history/positions", { ...query, step_s: step });
      return { courses: coursesOf(history), step };
    } catch (error) {
      if (!(error instanceof ApiError)) throw error;
      if (error.code === 404) return { courses: await oneByOne(span), step: null };
      if (error.code !== 422) throw error;
    }
  }
  throw new ApiError(422, "too-much", "the span is too long");
}

async function oneByOne(span: Span): Promise<Course[]> {
  const query = { from: iso(span.from), until: iso(span.until) };
  const [people, shifts] = await Promise.all([
    api.get<PersonNow[]>("/api/v1/people"),
    api.get<Shift[]>("/api/v1/attendance", query),
  ]);
  const keys = new Map<string, { person: string | null; id: string }>();
  for (const { person } of people) keys.set(keyOf(person.id, null), { person: person.id, id: person.id });
  for (const shift of shifts)
    if (shift.person == null && shift.tag != null) keys.set(keyOf(null, shift.tag), { person: null, id: shift.tag });
  const asked = [...keys].slice(0, TRACKS);
  const courses: Course[] = [];
  for (let from = 0; from < asked.length; from += AT_ONCE) {
    const tracks = asked.slice(from, from + AT_ONCE).map(async ([key, { person, id }]) => {
      const track = await api.get<Track>(`/api/v1/${person !== null ? "people" : "tags"}/${part(id)}/track`, {
        ...query,
        points: 2000,
      });
      return courseOfTrack(key, person, track);
    });
    courses.push(...(await Promise.all(tracks)).filter((course) => course.times.length > 0));
  }
  return courses;
}

export async function loadAlarms(span: Span): Promise<Alarm[]> {
  const page = await api.get<AlarmPage>("/api/v1/history/alarms", {
    from: iso(span.from),
    until: iso(span.until),
    limit: 500,
  });
  return page.rows;
}
