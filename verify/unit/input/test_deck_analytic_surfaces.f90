!> Unit test of deck_analytic_surfaces: local axes, lines, arcs, fillets, carrier nodes, and what is refused.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_deck_analytic_surfaces
  use amontons_kinds, only: DP, PI
  use amontons_analytic_profiles, only: profile_length, PROFILE_PLANAR, PROFILE_EXTRUDED, PROFILE_REVOLVED
  use amontons_deck, only: read_deck_text
  use amontons_deck_analytic_surfaces, only: is_analytic_type
  use amontons_errors, only: diagnostic_list_type, error_type
  use amontons_model, only: model_type, job_options_type, DIALECT_ABAQUS
  use check, only: suite_type
  use samples, only: deck_lines
  implicit none
  character(*), parameter :: MODEL_PART = '*NODE;1,0,0,0;2,1,0,0;3,1,1,0;4,0,1,0;5,0,0,1;6,1,0,1;7,1,1,1;8,0,1,1;90,1,2,3;' // &
    '*ELEMENT, TYPE=C3D8, ELSET=E;1,1,2,3,4,5,6,7,8;*MATERIAL, NAME=M;*ELASTIC;1.,0.;*SOLID SECTION, ELSET=E, MATERIAL=M;'
  character(*), parameter :: STEP_PART = '*RIGID BODY, ANALYTICAL SURFACE=S, REF NODE=90;*STEP;*STATIC;*END STEP;'
  character(*), parameter :: LINES = 'START,0,0;LINE,4,0;LINE,4,3;'
  real(DP), parameter :: TOL = 1.0e-14_DP            ! rounding of numbers of size 10
  type(suite_type) :: suite
  type(model_type) :: model
  call suite%that('types', is_analytic_type('SEGMENTS') .and. is_analytic_type('REVOLUTION') .and. .not. is_analytic_type('NODE'))
  call check_pieces()
  call check_axes()
  call check_fillets()
  call check_carriers()
  call check_errors()
  call suite%finish()

contains

  !> Two lines, and a quarter circle that turns left.
  subroutine check_pieces()
    call expect_read('*SURFACE, NAME=S, TYPE=SEGMENTS;' // LINES, model)
    associate (p => model%surfaces(1)%profile)
      call suite%that('two lines', p%n == 2 .and. p%kind == PROFILE_PLANAR)
      call suite%near('length', profile_length(p), 7.0_DP, TOL)
      call suite%near('the second begins where the first ends', maxval(abs(p%start(:, 2) - [4.0_DP, 0.0_DP])), 0.0_DP, 0.0_DP)
    end associate
    call expect_read('*SURFACE, NAME=S, TYPE=SEGMENTS;START,2,0;CIRCL,0,2,0,0;', model)
    associate (p => model%surfaces(1)%profile)
      call suite%near('quarter circle', profile_length(p), PI, TOL)
      call suite%near('radius', abs(p%signed_radius(1)), 2.0_DP, TOL)
    end associate
  end subroutine check_pieces


  !> The local axes: those of the model, given ones, and those of a revolution.
  subroutine check_axes()
    call expect_read('*SURFACE, NAME=S, TYPE=CYLINDER;' // LINES, model)
    associate (p => model%surfaces(1)%profile)
      call suite%that('extruded', p%kind == PROFILE_EXTRUDED)
      call suite%near('global axes', maxval(abs(p%axes - reshape([1.0_DP, 0.0_DP, 0.0_DP, 0.0_DP, 1.0_DP, 0.0_DP, 0.0_DP, 0.0_DP, &
        1.0_DP], [3, 3]))), 0.0_DP, TOL)
    end associate
    call expect_read('*SURFACE, NAME=S, TYPE=CYLINDER;1,2,3,1,5,3;4,2,3;' // LINES, model)
    associate (p => model%surfaces(1)%profile)
      call suite%near('origin', maxval(abs(p%origin - [1.0_DP, 2.0_DP, 3.0_DP])), 0.0_DP, 0.0_DP)
      call suite%near('x from a to b', maxval(abs(p%axes(:, 1) - [0.0_DP, 1.0_DP, 0.0_DP])), 0.0_DP, TOL)
      call suite%near('z against the generator', maxval(abs(p%axes(:, 3) - [-1.0_DP, 0.0_DP, 0.0_DP])), 0.0_DP, TOL)
      call suite%near('y = z x x', maxval(abs(p%axes(:, 2) - [0.0_DP, 0.0_DP, -1.0_DP])), 0.0_DP, TOL)
    end associate
    call expect_read('*SURFACE, NAME=S, TYPE=REVOLUTION;0,0,0,0,3,4;' // LINES, model)
    associate (p => model%surfaces(1)%profile)
      call suite%that('revolved', p%kind == PROFILE_REVOLVED)
      call suite%near('z along the axis', maxval(abs(p%axes(:, 3) - [0.0_DP, 0.6_DP, 0.8_DP])), 0.0_DP, TOL)
      call suite%near('orthogonal', maxval(abs(matmul(transpose(p%axes), p%axes) - reshape([1.0_DP, 0.0_DP, 0.0_DP, 0.0_DP, &
        1.0_DP, 0.0_DP, 0.0_DP, 0.0_DP, 1.0_DP], [3, 3]))), 0.0_DP, TOL)
    end associate
    call expect_read('*SURFACE, NAME=S, TYPE=REVOLUTION;' // LINES, model)
    call suite%near('about y', maxval(abs(model%surfaces(1)%profile%axes(:, 3) - [0.0_DP, 1.0_DP, 0.0_DP])), 0.0_DP, TOL)
    call expect_message('*SURFACE, NAME=S, TYPE=CYLINDER;0,0,0,1,0,0;1,0,-1;' // LINES, 'must be perpendicular')
    call expect_message('*SURFACE, NAME=S, TYPE=REVOLUTION;1,1,1,1,1,1;' // LINES, 'must differ from the origin')
  end subroutine check_axes


  !> A fillet of radius r at a right angle cuts r off each line and adds a quarter circle.
  subroutine check_fillets()
    call expect_read('*SURFACE, NAME=S, TYPE=SEGMENTS, FILLET RADIUS=1.;' // LINES, model)
    associate (p => model%surfaces(1)%profile)
      call suite%that('three pieces', p%n == 3)
      call suite%near('length', profile_length(p), 3.0_DP + PI / 2 + 2.0_DP, TOL)
      call suite%near('centre', maxval(abs(p%centre(:, 2) - [3.0_DP, 1.0_DP])), 0.0_DP, TOL)
      call suite%near('ends on the line', maxval(abs(p%finish(:, 2) - [4.0_DP, 1.0_DP])), 0.0_DP, TOL)
    end associate
    call expect_read('*SURFACE, NAME=S, TYPE=SEGMENTS, FILLET RADIUS=1.;START,0,0;LINE,4,0;LINE,4,-3;', model)
    call suite%near('to the right', maxval(abs(model%surfaces(1)%profile%centre(:, 2) - [3.0_DP, -1.0_DP])), 0.0_DP, TOL)
    call expect_message('*SURFACE, NAME=S, TYPE=SEGMENTS, FILLET RADIUS=2.;' // LINES, 'longer than twice')
    call expect_message('*SURFACE, NAME=S, TYPE=SEGMENTS, FILLET RADIUS=-1.;' // LINES, 'must be a positive number')
    call expect_message('*SURFACE, NAME=S, TYPE=SEGMENTS, FILLET RADIUS=.1;START,0,0;LINE,4,0;CIRCL,8,0,6,-.5;', &
      'give the arc at piece 1 by CIRCL')
  end subroutine check_fillets


  !> RIGID BODY: nodes at the reference node and along the axes, as far as the profile is long; three in the plane.
  subroutine check_carriers()
    integer :: k
    call expect_read('*SURFACE, NAME=S, TYPE=CYLINDER;' // LINES, model)
    associate (s => model%surfaces(1), x => model%mesh%coordinates)
      call suite%that('four nodes in one body', size(s%nodes) == 4 .and. size(model%nonlinear_mpcs) == 1)
      if (size(s%nodes) /= 4) return
      call suite%that('of the body', all(model%nonlinear_mpcs(1)%node == s%nodes) .and. model%nonlinear_mpcs(1)%reference == 9)
      call suite%near('at the reference node', maxval(abs(x(:, s%nodes(1)) - [1.0_DP, 2.0_DP, 3.0_DP])), 0.0_DP, 0.0_DP)
      do k = 1, 3
        call suite%near('along an axis', x(k, s%nodes(k + 1)) - x(k, s%nodes(1)), 7.0_DP, TOL)
      end do
    end associate
    call expect_read('*SURFACE, NAME=S, TYPE=SEGMENTS;' // LINES, model)
    call suite%that('three in the plane', size(model%surfaces(1)%nodes) == 3 .and. .not. model%nonlinear_mpcs(1)%is_bound(3) .and. &
      all(model%mesh%is_unstiffened(3, model%surfaces(1)%nodes)))
  end subroutine check_carriers


  !> What is refused: one message each, and none of what follows from it.
  subroutine check_errors()
    character(*), parameter :: SURFACE = '*SURFACE, NAME=S, TYPE=SEGMENTS;'
    call expect_message(SURFACE // 'LINE,1,0;', 'START once')
    call expect_message(SURFACE // 'START,0,0;LINE,1,0;START,2,0;', 'START once')
    call expect_message(SURFACE // 'START,0,0;', 'has no pieces')
    call expect_message(SURFACE // 'START,0,0;PARAB,1,0,2,0;', 'put CIRCL for PARAB')
    call expect_message(SURFACE // 'START,0,0;LINE,0,0;', 'has no length')
    call expect_message(SURFACE // 'START,2,0;CIRCL,0,3,0,0;', 'must be equally far')
    call expect_message(SURFACE // 'START,2,0;CIRCL,-2,0,0,0;', 'less than half a circle')
    call expect_message('*SURFACE, NAME=S, TYPE=REVOLUTION;START,1,0;LINE,-1,1;', 'must not be negative')
    call expect_message(SURFACE // LINES, 'needs a *RIGID BODY', step='*STEP;*STATIC;*END STEP;')
  end subroutine check_errors


  include 'sample_deck.inc'

end program test_deck_analytic_surfaces
