/** Finding people by what somebody types: beginnings of names first, then what contains it. */
import type { Subject } from "./subject";

export function search(subjects: Iterable<Subject>, words: string, limit = 50): Subject[] {
  const wanted = words.trim().toLocaleLowerCase();
  if (wanted === "") return [];
  const ranked: { subject: Subject; rank: number }[] = [];
  for (const subject of subjects) {
    const rank = rankOf(subject, wanted);
    if (rank >= 0) ranked.push({ subject, rank });
  }
  ranked.sort((a, b) => a.rank - b.rank || a.subject.name.localeCompare(b.subject.name));
  return ranked.slice(0, limit).map(({ subject }) => subject);
}

function rankOf(subject: Subject, wanted: string): number {
  const name = subject.name.toLocaleLowerCase();
  if (name.startsWith(wanted)) return 0;
  if (name.split(/\s+/).some((part) => part.startsWith(wanted))) return 1;
  const ids = [subject.person, subject.tag].map((id) => id?.toLocaleLowerCase() ?? "");
  if (ids.some((id) => id.startsWith(wanted))) return 2;
  if (name.includes(wanted) || ids.some((id) => id.includes(wanted))) return 3;
  return -1;
}
