/**
 * The tools themselves, with what they show and say. All of this is a script of its own, which is fetched when the first of
 * them is needed; what it shares with the rest is handed to it.
 */

import { toolStyles } from '../styles/tools.js';
import { ToolBar } from './bar.js';
import { DriveDriver } from './drives.js';
import { EditTool } from './edit.js';
import { EditDriver } from './edits.js';
import { Families } from './families.js';
import { KeysDialog } from './keys.js';
import { Marks } from './marks.js';
import { PathTool } from './path.js';
import { PlaceTool } from './place.js';
import { PoseTool } from './pose.js';
import { Share } from './share.js';
import { TimingTool } from './timing.js';
import { WanderTool } from './wander.js';

const ALL = [PoseTool, PlaceTool, PathTool, TimingTool, WanderTool, EditTool];

/** One player's tools, in its view. */
export class Tools {
  /** @param {import('./toolbox.js').Toolbox} box */
  constructor(box) {
    const { view, host } = box.core;
    view.addStyles(toolStyles);
    this.edits = new EditDriver(box);
    this.drives = new DriveDriver(box);
    this.families = new Families(box);
    this.byName = Object.fromEntries(ALL.map((Tool) => [Tool.id, new Tool(box)]));
    this.marks = new Marks();
    this.bar = new ToolBar(ALL, { choose: (name) => (host.tool = name), step: (by) => box.undo(by), hurry: (quickness) => (host.quickness = Number(quickness.toFixed(4))), vary: (variety) => (host.variety = variety) });
    this.bar.root.append(new Share(box).root);
    this.keys = new KeysDialog();
    view.bar.append(this.bar.root);
    view.root.append(this.keys.root);
    this.host = host;
  }

  /** What a tool marks on the ground, as the stage takes it. */
  drawn(tool) {
    this.marks.clear();
    tool.draw?.(this.marks, coloursOf(this.host));
    return this.marks.data;
  }
}

/** The page's colours, as bytes. @returns {(name: string, opacity?: number) => [number, number, number, number]} */
function coloursOf(host) {
  const style = getComputedStyle(host);
  return (name, opacity = 1) => {
    const value = style.getPropertyValue(`--${name}`).trim();
    const hex = /^#([0-9a-f]{6})$/i.exec(value);
    const number = hex ? parseInt(hex[1], 16) : 0x3558c4;
    return [number >> 16, (number >> 8) & 255, number & 255, Math.round(opacity * 255)];
  };
}
