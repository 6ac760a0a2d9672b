!> Unit test of general_contact: which faces are near, which body is the slave and why, rules, ties, sheets, reach, profiles.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_general_contact
  use amontons_kinds, only: DP
  use amontons_deck, only: read_deck_text
  use amontons_errors, only: diagnostic_list_type, error_type
  use amontons_text, only: to_text
  use amontons_model, only: model_type, job_options_type
  use amontons_general_contact, only: general_pairs_type, find_general_pairs
  use amontons_loads, only: equation_type
  use amontons_tie_generation, only: generate_ties
  use check, only: suite_type
  use samples, only: deck_lines
  implicit none
  character(*), parameter :: GENERAL = '*CONTACT;*CONTACT INCLUSIONS, ALL EXTERIOR;'
  character(*), parameter :: LINEAR_STEP = '*STEP;*STATIC;*BOUNDARY;11,1,3;*END STEP;'
  type(suite_type) :: suite
  type(general_pairs_type) :: found
  character(:), allocatable :: text
  integer :: p
  call check_two_blocks()
  call check_roles()
  call check_rules()
  call check_sheets()
  call check_corner()
  call check_motion()
  call check_profile()
  call suite%finish()

contains

  !> The cards of a block of one C3D8 with its lowest corner at x and edges a; its element set is NAME, its surface NAME_S.
  function block(name, number, x, a, modulus) result(cards)
    character(*), intent(in) :: name
    integer, intent(in) :: number                  !< of the element; its nodes are 10 number + 1 to 8
    real(DP), intent(in) :: x(3), a(3), modulus
    character(:), allocatable :: cards
    integer, parameter :: CORNER(3, 8) = reshape([0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 0, 1, 1, 0, 1, 1, 1, 1, 0, 1, 1], [3, 8])
    real(DP) :: p(3)
    integer :: i
    cards = '*NODE, NSET=N' // name // ';'
    do i = 1, 8
      p = x + a * real(CORNER(:, i), DP)
      cards = cards // to_text(10 * number + i) // ',' // to_text(p(1)) // ',' // to_text(p(2)) // ',' // to_text(p(3)) // ';'
    end do
    cards = cards // '*ELEMENT, TYPE=C3D8, ELSET=' // name // ';' // to_text(number)
    do i = 1, 8
      cards = cards // ',' // to_text(10 * number + i)
    end do
    cards = cards // ';*MATERIAL, NAME=' // name // ';*ELASTIC;' // to_text(modulus) // ',0.3;*SOLID SECTION, ELSET=' // name // &
      ', MATERIAL=' // name // ';*SURFACE, NAME=' // name // '_S;' // name // ',;'
  end function block


  !> A small block on a large one: the lower face of the upper is the slave, the upper face of the lower the master.
  subroutine check_two_blocks()
    call find(two_blocks(0.0_DP, 100.0_DP, 100.0_DP) // GENERAL // LINEAR_STEP)
    call suite%that('one pair', size(found%pairs) == 1 .and. size(found%surfaces) == 2)
    call suite%that('faces that oppose', all(found%surfaces(1)%face == [1]) .and. all(found%surfaces(2)%face == [2]))
    call suite%that('slave above', all(found%surfaces(1)%element == [2]) .and. all(found%surfaces(2)%element == [1]))
    call suite%that('indices in the model', found%pairs(1)%slave == 3 .and. found%pairs(1)%master == 4 .and. &
      found%pairs(1)%is_mortar .and. found%pairs(1)%is_general)
    call suite%that('nodes of the slave', all(found%surfaces(1)%nodes == [9, 10, 11, 12]))
    call suite%that('named', index(text, 'slave UP#') > 0 .and. index(text, 'master LOW') > 0 .and. index(text, 'finer mesh') > 0)
    call find(two_blocks(2.0_DP, 100.0_DP, 100.0_DP) // GENERAL // LINEAR_STEP)
    call suite%that('at a gap within the search radius', size(found%pairs) == 1)
    call find(two_blocks(12.0_DP, 100.0_DP, 100.0_DP) // GENERAL // LINEAR_STEP)
    call suite%that('too far', size(found%pairs) == 0 .and. index(text, '0 pairs of 2') > 0)
    call find(two_blocks(-0.2_DP, 100.0_DP, 100.0_DP) // GENERAL // LINEAR_STEP)
    call suite%that('overlapping', size(found%pairs) == 1)
    call find(two_blocks(0.0_DP, 100.0_DP, 100.0_DP) // '*CONTACT, TYPE=NODE TO SURFACE;*CONTACT INCLUSIONS, ALL EXTERIOR;' // &
      LINEAR_STEP)
    call suite%that('node to surface', .not. found%pairs(1)%is_mortar)
    call find(two_blocks(12.0_DP, 100.0_DP, 100.0_DP) // '*CONTACT, REACH=20.;*CONTACT INCLUSIONS, ALL EXTERIOR;' // LINEAR_STEP)
    call suite%that('within REACH', size(found%pairs) > 0)
    call find(two_blocks(0.0_DP, 100.0_DP, 100.0_DP) // LINEAR_STEP)
    call suite%that('no general contact', size(found%pairs) == 0 .and. text == '')
  end subroutine check_two_blocks


  !> Supports, stiffness and the deck decide before the mesh.
  subroutine check_roles()
    call find(two_blocks(0.0_DP, 300.0_DP, 100.0_DP) // GENERAL // LINEAR_STEP)
    call suite%that('the softer is the slave', all(found%surfaces(1)%element == [1]) .and. index(text, 'softer') > 0)
    call find(two_blocks(0.0_DP, 100.0_DP, 140.0_DP) // GENERAL // LINEAR_STEP)
    call suite%that('not if they are alike', all(found%surfaces(1)%element == [2]))
    call find(two_blocks(0.0_DP, 100.0_DP, 302.0_DP) // GENERAL // '*STEP;*STATIC;*BOUNDARY;NUP,3,3;*END STEP;')
    call suite%that('who is held is the master', all(found%surfaces(1)%element == [1]) .and. index(text, 'supports hold') > 0)
    call find(two_blocks(0.0_DP, 100.0_DP, 302.0_DP) // GENERAL // '*STEP;*STATIC;*BOUNDARY;NUP,1,2;*END STEP;')
    call suite%that('supports along the face do not count', all(found%surfaces(1)%element == [2]))
    call find(two_blocks(0.0_DP, 100.0_DP, 302.0_DP) // '*NODE;99,0,0,9;*RIGID BODY, ELSET=UP, REF NODE=99;' // GENERAL // &
      LINEAR_STEP)
    call suite%that('who is rigid is the master', all(found%surfaces(1)%element == [1]) .and. index(text, 'rigid') > 0)
    call find(two_blocks(0.0_DP, 100.0_DP, 302.0_DP) // GENERAL // '*CONTACT FORMULATION, ' // &
      'TYPE=MASTER SLAVE ROLES;UP_S,LOW_S,MASTER;' // LINEAR_STEP)
    call suite%that('the deck', all(found%surfaces(1)%element == [1]) .and. index(text, 'CONTACT FORMULATION') > 0)
  end subroutine check_roles


  !> Inclusions, exclusions, ties, given pairs, and the last assignment.
  subroutine check_rules()
    character(*), parameter :: LAWS = '*SURFACE INTERACTION, NAME=A;*SURFACE INTERACTION, NAME=B;'
    character(:), allocatable :: blocks
    blocks = two_blocks(0.0_DP, 100.0_DP, 100.0_DP) // LAWS
    call find(blocks // '*CONTACT;*CONTACT INCLUSIONS;UP_S, LOW_S;' // LINEAR_STEP)
    call suite%that('included', size(found%pairs) == 1)
    call find(blocks // '*CONTACT;*CONTACT INCLUSIONS;UP_S;LOW_S;' // LINEAR_STEP)
    call suite%that('each with itself only', size(found%pairs) == 0)
    call find(blocks // GENERAL // '*CONTACT EXCLUSIONS;LOW_S, UP_S;' // LINEAR_STEP)
    call suite%that('excluded', size(found%pairs) == 0)
    call find(blocks // '*TIE, NAME=T;UP_S, LOW_S;' // GENERAL // LINEAR_STEP)
    call suite%that('tied', size(found%pairs) == 0)
    call find(two_blocks(0.5_DP, 100.0_DP, 100.0_DP) // '*TIE, NAME=T, POSITION TOLERANCE=0.6;UP_S, LOW_S;' // GENERAL // &
      LINEAR_STEP)
    call suite%that('tied across a gap', size(found%pairs) == 0)
    call find(blocks // '*CONTACT INITIALIZATION DATA, NAME=I, SEARCH ABOVE=0.5, SEARCH BELOW=0.25;*CONTACT INITIALIZATION DATA, ' &
      // 'NAME=F, INTERFERENCE FIT;' // GENERAL // '*CONTACT INITIALIZATION ASSIGNMENT;,,F;UP_S,LOW_S,I;' // LINEAR_STEP)
    associate (pair => found%pairs(1))
      call suite%that('moved', pair%has_adjust .and. .not. pair%is_shrink_fit)
      call suite%near('within these distances', abs(pair%adjust - 0.5_DP) + abs(pair%adjust_depth - 0.25_DP), 0.0_DP, 0.0_DP)
    end associate
    call find(blocks // '*CONTACT INITIALIZATION DATA, NAME=F, INTERFERENCE FIT;' // GENERAL // &
      '*CONTACT INITIALIZATION ASSIGNMENT;,,F;' // LINEAR_STEP)
    call suite%that('a fit', found%pairs(1)%is_shrink_fit .and. .not. found%pairs(1)%has_adjust)
    call find(blocks // '*CONTACT PAIR, INTERACTION=A;UP_S, LOW_S;' // GENERAL // LINEAR_STEP)
    call suite%that('given as a pair', size(found%pairs) == 0)
    call find(blocks // GENERAL // '*CONTACT PROPERTY ASSIGNMENT;,,A;LOW_S,UP_S,B;' // LINEAR_STEP)
    call suite%that('the last assignment', found%pairs(1)%interaction == 2)
    call find(blocks // GENERAL // '*CONTACT PROPERTY ASSIGNMENT;LOW_S,UP_S,B;,,A;' // LINEAR_STEP)
    call suite%that('in their order', found%pairs(1)%interaction == 1)
    call find(blocks // GENERAL // LINEAR_STEP)
    call suite%that('without one', found%pairs(1)%interaction == 3)
  end subroutine check_rules


  !> Two thin sheets on each other: their far sides oppose each other too, but one lies behind the other.
  subroutine check_sheets()
    call find(block('LOW', 1, [0.0_DP, 0.0_DP, 0.0_DP], [2.0_DP, 2.0_DP, 0.1_DP], 100.0_DP) // &
      block('UP', 2, [0.0_DP, 0.0_DP, 0.1_DP], [2.0_DP, 2.0_DP, 0.1_DP], 100.0_DP) // GENERAL // LINEAR_STEP)
    call suite%that('sheets: one pair', size(found%pairs) == 1)
    call suite%that('sheets: the sides that touch', found%surfaces(1)%face(1) + found%surfaces(2)%face(1) == 3)
  end subroutine check_sheets


  !> A block in a corner of two others: a pair for each of its sides, each with one face as slave.
  subroutine check_corner()
    call find(block('FLOOR', 1, [-3.0_DP, -3.0_DP, -1.0_DP], [8.0_DP, 8.0_DP, 1.0_DP], 900.0_DP) // &
      block('WALL', 2, [1.0_DP, -3.0_DP, 0.05_DP], [1.0_DP, 8.0_DP, 4.0_DP], 900.0_DP) // &
      block('BOX', 3, [0.0_DP, 0.0_DP, 0.0_DP], [1.0_DP, 1.0_DP, 1.0_DP], 100.0_DP) // GENERAL // &
      '*CONTACT EXCLUSIONS;FLOOR_S,WALL_S;' // LINEAR_STEP)
    call suite%that('corner: two pairs', size(found%pairs) == 2)
    call suite%that('corner: a side each', all(found%surfaces(1)%face == [1]) .and. all(found%surfaces(3)%face == [4]))
    call suite%that('corner: on their own masters', found%surfaces(2)%element(1) == 1 .and. &
      found%surfaces(4)%element(1) == 2)
  end subroutine check_corner


  !> Under NLGEOM a prescribed displacement widens the search; without NLGEOM it does not.
  subroutine check_motion()
    character(*), parameter :: PUSH = '*STATIC;*BOUNDARY;NLOW,1,3;NUP,3,3,-13.;*END STEP;'
    call find(two_blocks(12.0_DP, 100.0_DP, 100.0_DP) // GENERAL // '*STEP;' // PUSH)
    call suite%that('small displacements', size(found%pairs) == 0)
    call find(two_blocks(12.0_DP, 100.0_DP, 100.0_DP) // GENERAL // '*STEP, NLGEOM;' // PUSH)
    call suite%that('a long way', any([(any(found%surfaces(2 * p - 1)%face == 1) .or. any(found%surfaces(2 * p)%face == 1), &
      p=1, size(found%pairs))]))
    call find(two_blocks(12.0_DP, 100.0_DP, 100.0_DP) // GENERAL // '*STEP, NLGEOM;*STATIC;' // &
      '*BOUNDARY;NLOW,1,3;NUP,3,3,-1.;*END STEP;')
    call suite%that('too short a way', size(found%pairs) == 0)
  end subroutine check_motion


  !> A block on an analytic plane.
  subroutine check_profile()
    character(*), parameter :: PLANE = '*NODE;99,0,0,-1;*SURFACE, NAME=TABLE, TYPE=CYLINDER;0.,0.,0.,1.,0.,0.;0.,-1.,0.;' // &
      'START,5.,0.;LINE,-5.,0.;*RIGID BODY, ANALYTICAL SURFACE=TABLE, REF NODE=99;'
    call find(block('BOX', 1, [0.0_DP, 0.0_DP, 0.0_DP], [1.0_DP, 1.0_DP, 1.0_DP], 100.0_DP) // PLANE // GENERAL // LINEAR_STEP)
    call suite%that('on the plane', size(found%pairs) == 1 .and. size(found%surfaces) == 1)
    if (size(found%pairs) /= 1) return
    call suite%that('its master is the profile', found%pairs(1)%master == 2 .and. .not. found%pairs(1)%is_mortar)
    call find(block('BOX', 1, [0.0_DP, 0.0_DP, 0.0_DP], [1.0_DP, 1.0_DP, 1.0_DP], 100.0_DP) // PLANE // GENERAL // &
      '*CONTACT EXCLUSIONS;BOX_S, TABLE;' // LINEAR_STEP)
    call suite%that('excluded profile', size(found%pairs) == 0)
  end subroutine check_profile


  !> LOW, 3 x 3 x 1, and UP, 1 x 1 x 1, above it at a gap.
  function two_blocks(gap, modulus_up, modulus_low) result(cards)
    real(DP), intent(in) :: gap, modulus_up, modulus_low
    character(:), allocatable :: cards
    cards = block('LOW', 1, [-1.0_DP, -1.0_DP, -1.0_DP], [3.0_DP, 3.0_DP, 1.0_DP], modulus_low) // &
      block('UP', 2, [0.0_DP, 0.0_DP, gap], [1.0_DP, 1.0_DP, 1.0_DP], modulus_up)
  end function two_blocks


  !> Reads a deck, whose lines end with semicolons, and finds its pairs.
  subroutine find(cards)
    character(*), intent(in) :: cards
    type(model_type) :: model
    type(diagnostic_list_type) :: diagnostics
    type(error_type), allocatable :: error
    type(job_options_type) :: options
    type(equation_type), allocatable :: equations(:)
    character(:), allocatable :: warnings
    real(DP), allocatable :: coordinates(:, :)
    integer :: i
    call read_deck_text(deck_lines(cards), options, model, diagnostics, error)
    call suite%that('deck', .not. allocated(error))
    if (allocated(error)) then
      do i = 1, diagnostics%n_items
        call suite%that(diagnostics%items(i)%text, diagnostics%items(i)%is_warning)
      end do
      return
    end if
    if (allocated(model%ties)) call generate_ties(model, equations, coordinates, warnings, error)
    if (allocated(equations)) model%equations = [model%equations, equations]
    call find_general_pairs(model, found, text)
  end subroutine find

end program test_general_contact
