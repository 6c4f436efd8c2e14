/** Click a pose in the score, and the actor goes there. All of it is the score's; the tool is there to be chosen. */

export class PoseTool {
  static id = 'pose';
  static title = 'Pose';
  static about = 'Click a pose: the actor goes there';

  id = PoseTool.id;
  hint = 'Click a pose: the actor goes there.';
}
