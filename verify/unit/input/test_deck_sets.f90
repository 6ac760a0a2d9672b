!> Unit test of deck_sets: order of members, sets that come later, ranges, nodes of elements, and what is refused.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_deck_sets
  use amontons_deck, only: read_deck_text
  use amontons_errors, only: diagnostic_list_type, error_type
  use amontons_model, only: model_type, job_options_type, DIALECT_ABAQUS, DIALECT_CALCULIX
  use check, only: suite_type
  use samples, only: deck_lines
  implicit none
  character(*), parameter :: MODEL_PART = '*NODE, NSET=ALL;10,0,0,0;20,1,0,0;30,1,1,0;40,0,1,0;50,0,0,1;60,1,0,1;' // &
    '70,1,1,1;80,0,1,1;90,0,0,2;*ELEMENT, TYPE=C3D8, ELSET=E;7,10,20,30,40,50,60,70,80;*MATERIAL, NAME=M;*ELASTIC;1.,0.;' // &
    '*SOLID SECTION, ELSET=E, MATERIAL=M;'
  character(*), parameter :: STEP_PART = '*STEP;*STATIC;*END STEP;'
  type(suite_type) :: suite
  call check_members()
  call check_repeats()
  call check_errors()
  call suite%finish()

contains

  !> A set of nodes has given members, by label.
  subroutine expect_nodes(text, name, labels, dialect)
    character(*), intent(in) :: text, name
    integer, intent(in) :: labels(:)
    integer, intent(in), optional :: dialect
    type(model_type) :: model
    logical :: is_right
    integer :: s, n_found
    call expect_read(text, model, dialect=dialect)
    is_right = .false.
    n_found = 0
    do s = 1, size(model%mesh%node_sets)
      associate (set => model%mesh%node_sets(s))
        if (set%name /= name) cycle
        n_found = n_found + 1
        is_right = size(set%members) == size(labels)
        if (is_right) is_right = all(model%mesh%node_label(set%members) == labels)
      end associate
    end do
    call suite%that('members of ' // name // ' by ' // text, is_right .and. n_found == 1)
  end subroutine expect_nodes


  !> Order of the numbers or as written, each once; several cards; sets that come later; ranges skip what is missing; nodes of
  !! elements.
  subroutine check_members()
    call expect_nodes('*NSET, NSET=A;30,10,,30;20;', 'A', [10, 20, 30])
    call expect_nodes('*NSET, NSET=A, UNSORTED;30,10,,30;20;', 'A', [30, 10, 20])
    call expect_nodes('*NSET, NSET=A, UNSORTED;30;*NSET, NSET=B;40;*NSET, NSET=a;20;', 'A', [30, 20])
    call expect_nodes('*NSET, NSET=A;B,90;*NSET, NSET=B;C,20;*NSET, NSET=C;10;', 'A', [10, 20, 90])
    call expect_nodes('*NSET, NSET=A;20,A;', 'A', [20])
    call expect_nodes('*NSET, NSET=A, GENERATE;20,55,15;', 'A', [20, 50])
    call expect_nodes('*NSET, NSET=A, GENERATE;20;*NSET, NSET=A, GENERATE;15,40,5;', 'A', [20, 30, 40])
    call expect_nodes('*NSET, NSET=A, ELSET=E;', 'A', [10, 20, 30, 40, 50, 60, 70, 80])
    call expect_nodes('*NODE, NSET=NEW;95,0,0,3;94,0,0,4;*NSET, NSET=NEW;10;', 'NEW', [10, 94, 95])
    call expect_nodes('*NODE, NSET=NEW;95,0,0,3;94,0,0,4;*NSET, NSET=NEW;10;', 'NEW', [95, 94, 10], DIALECT_CALCULIX)
  end subroutine check_members


  !> A member that is named more than once counts once; CalculiX counts it twice, which a note says.
  subroutine check_repeats()
    character(*), parameter :: STEP = '*STEP;*STATIC;*CLOAD;A,1,2.;*END STEP;'
    type(model_type) :: model
    call expect_read('*NSET, NSET=A;10,20,10;', model, step=STEP)
    call suite%that('two forces', size(model%steps(1)%concentrated) == 2)
    call expect_message('*NSET, NSET=A;10,20,10;', 'more than once', dialect=DIALECT_CALCULIX, step=STEP, is_note=.true.)
    call expect_message('*NSET, NSET=A;10,99;', 'no node 99', dialect=DIALECT_CALCULIX, is_note=.true.)
  end subroutine check_repeats


  !> Unknown members, circles, and invalid ranges.
  subroutine check_errors()
    call expect_message('*NSET, NSET=A;10,99;', 'There is no node 99.')
    call expect_message('*NSET, NSET=A;10,Q;', 'There is no node set ''Q''.')
    call expect_message('*ELSET, ELSET=A;8;', 'There is no element 8.')
    call expect_message('*NSET, NSET=A;B;*NSET, NSET=B;C;*NSET, NSET=C;A;', 'contain each other')
    call expect_message('*NSET, NSET=A, GENERATE;40,20;', 'first <= last')
    call expect_message('*NSET, NSET=A, GENERATE;20,40,0;', 'step of at least 1')
    call expect_message('*NSET, NSET=A, GENERATE;20,40,10,1;', 'at most 3')
    call expect_message('*NSET, NSET=A, GENERATE;21,29;', 'no node that exists', is_note=.true.)
    call expect_message('*NSET, NSET=A, ELSET=Q;', 'There is no element set ''Q''.')
    call expect_message('*NSET, NSET=A, INSTANCE=I;10;', 'this deck has none')
  end subroutine check_errors


  include 'sample_deck.inc'

end program test_deck_sets
