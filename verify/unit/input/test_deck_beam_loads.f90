!> Unit test of deck_beam_loads: sides and pressures of P1 and P2, forces per volume of PX, and what is refused.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_deck_beam_loads
  use amontons_kinds, only: DP, PI
  use amontons_deck, only: read_deck_text
  use amontons_errors, only: diagnostic_list_type, error_type
  use amontons_loads, only: DISTRIBUTED_PRESSURE, DISTRIBUTED_BODY_FORCE
  use amontons_model, only: model_type, job_options_type, DIALECT_ABAQUS, DIALECT_CALCULIX
  use check, only: suite_type
  use samples, only: deck_lines
  implicit none
  character(*), parameter :: MODEL_PART = '*NODE, NSET=N;1,0,0,0;2,1,0,0;3,2,0,0;11,0,5,0;12,1,5,0;*MATERIAL, NAME=M;*ELASTIC;' // &
    '100.,0.25;*ELEMENT, TYPE=B31, ELSET=B;1,1,2;2,2,3;*ELEMENT, TYPE=T3D2, ELSET=T;3,11,12;*SOLID SECTION, ELSET=T, ' // &
    'MATERIAL=M;1.;'
  character(*), parameter :: STEP_PART = '*STEP;*STATIC;*END STEP;'
  type(suite_type) :: suite
  call check_sides()
  call check_volumes()
  call check_errors()
  call suite%finish()

contains

  !> P1 acts on the side against direction 1, over the dimension along direction 2; P2 the other way round. In the calculix dialect
  !! the value is the pressure.
  subroutine check_sides()
    type(model_type) :: model
    integer :: dialect
    do dialect = min(DIALECT_ABAQUS, DIALECT_CALCULIX), max(DIALECT_ABAQUS, DIALECT_CALCULIX)
      call read_loads('RECT;.2,.4;', 'B,P1,8.;1,P2,6.;', dialect, model)
      associate (loads => model%steps(1)%distributed)
        call suite%that('loads', size(loads) == 3)
        if (size(loads) /= 3) return
        call suite%that('pressures', all(loads%kind == DISTRIBUTED_PRESSURE))
        call suite%that('elements', all(loads%element == [1, 2, 1]) .and. all(loads%face == [1, 1, 5]))
        call suite%near('pressure', norm2(loads%end - merge([real(DP) :: 8, 8, 6], [real(DP) :: 20, 20, 30], dialect == &
          DIALECT_CALCULIX)), 0.0_DP, 1.0e-12_DP)
      end associate
    end do
  end subroutine check_sides


  !> The force over the area.
  subroutine check_volumes()
    type(model_type) :: model
    call read_loads('RECT;.2,.4;', 'B,PY,8.;', DIALECT_ABAQUS, model)
    call expect_force(model, 'rectangle', [real(DP) :: 0, 100, 0])
    call read_loads('CIRC;.5;', 'B,PZ,8.;', DIALECT_ABAQUS, model)
    call expect_force(model, 'circle', [0.0_DP, 0.0_DP, 32 / PI])
    call read_loads('PIPE;.5,.1;', 'B,PX,8.;', DIALECT_ABAQUS, model)
    call expect_force(model, 'pipe', [8 / (0.09_DP * PI), 0.0_DP, 0.0_DP])
  end subroutine check_volumes


  !> Reports all body forces that differ.
  subroutine expect_force(model, name, force)
    type(model_type), intent(in) :: model
    character(*), intent(in) :: name
    real(DP), intent(in) :: force(3)               !< per volume
    integer :: i
    associate (loads => model%steps(1)%distributed)
      call suite%that(name // ': two elements', size(loads) == 2 .and. all(loads%kind == DISTRIBUTED_BODY_FORCE))
      do i = 1, size(loads)
        call suite%near(name, norm2(loads(i)%end * loads(i)%direction - force), 0.0_DP, 1.0e-12_DP)
      end do
    end associate
  end subroutine expect_force


  !> Other elements, a beam by its section, and the calculix dialect, which has P1 and P2 alone.
  subroutine check_errors()
    call expect_load_error('RECT;.2,.4;', 'T,PX,1.;', DIALECT_ABAQUS, 'is for beams of solid and hollow sections; the element 3')
    call expect_load_error('I;.1,.2,.1,.1,.01,.01,.01;0,1,0;', 'B,PX,1.;', DIALECT_ABAQUS, 'Beams by their section take *CLOAD')
    call expect_load_error('RECT;.2,.4;', 'B,P3,1.;', DIALECT_ABAQUS, 'beams P1 and P2')
    call expect_load_error('RECT;.2,.4;', 'B,PX,1.;', DIALECT_CALCULIX, 'The second field must be')
  end subroutine check_errors


  !> Reads a deck with a section and rows of DLOAD.
  subroutine read_loads(section, rows, dialect, model)
    character(*), intent(in) :: section, rows
    integer, intent(in) :: dialect
    type(model_type), intent(out) :: model
    call expect_read('*BEAM SECTION, ELSET=B, MATERIAL=M, SECTION=' // section, model, dialect, &
      '*STEP;*STATIC;*BOUNDARY;1,1,6;*DLOAD;' // rows // '*END STEP;')
  end subroutine read_loads


  !> Expects an error with a piece of text.
  subroutine expect_load_error(section, rows, dialect, piece)
    character(*), intent(in) :: section, rows, piece
    integer, intent(in) :: dialect
    call expect_message('*BEAM SECTION, ELSET=B, MATERIAL=M, SECTION=' // section, piece, dialect, &
      '*STEP;*STATIC;*BOUNDARY;1,1,6;*DLOAD;' // rows // '*END STEP;')
  end subroutine expect_load_error


  include 'sample_deck.inc'

end program test_deck_beam_loads
