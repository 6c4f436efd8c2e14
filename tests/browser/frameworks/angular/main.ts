/** Angular: the component says that there are elements which are not its own (`CUSTOM_ELEMENTS_SCHEMA`). */

import { Component, CUSTOM_ELEMENTS_SCHEMA, ElementRef, provideZonelessChangeDetection, signal, viewChild } from '@angular/core';
import { bootstrapApplication } from '@angular/platform-browser';
import 'reprise-player';
import type { ReprisePlayer } from 'reprise-player';

interface Props {
  shown: boolean;
  src: string;
  alt?: string;
  tint: boolean;
  controls: boolean;
  speed?: number;
  theme: string | null;
  direction?: object;
  count: number;
}

interface Page {
  first: Props;
  told: string[];
  set(changes: Partial<Props>): void;
  go(frame: number): unknown;
}

const page = window as unknown as Page;

@Component({
  selector: 'app-root',
  schemas: [CUSTOM_ELEMENTS_SCHEMA],
  template: `
    <main>
      <output>{{ props().count }}</output>
      @if (props().shown) {
        <reprise-player
          #player
          [src]="props().src"
          [alt]="props().alt"
          [tint]="props().tint"
          [controls]="props().controls"
          [speed]="props().speed"
          [theme]="props().theme"
          [direction]="props().direction"
          (ready)="told($event)"
          (load)="told($event)"
          (arrive)="told($event)"
          (error)="told($event)"
        ></reprise-player>
      }
    </main>
  `,
})
class App {
  readonly props = signal<Props>(page.first);
  readonly player = viewChild<ElementRef<ReprisePlayer>>('player');

  constructor() {
    page.set = (changes) => this.props.update((before) => ({ ...before, ...changes }));
    page.go = (frame) => this.player()?.nativeElement.goTo(frame);
  }

  told({ type }: Event): void {
    page.told.push(type);
  }
}

const root = document.createElement('app-root');
document.getElementById('app')?.append(root);
bootstrapApplication(App, { providers: [provideZonelessChangeDetection()] });
